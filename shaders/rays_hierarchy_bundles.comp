// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// The level of the hierarchy that `hybrid` walks: nodes over BUNDLE rays, bounded at once from the rays (tighter than three
// levels of unions, and one dispatch), a subgroup a node. Bundles that are too wide to be walked as one go to a list.
#define COMPUTE
#include "common.glsl"
#include "rays.glsl"
#include "lists.glsl"
#include "args.glsl"
#include "ray_node.glsl"
BUFFER(ROLE_RAY_NODES, writeonly, float, ray_nodes);
BUFFER(ROLE_WORK, writeonly, uint, work);
layout(push_constant) uniform Push {
  uint kind;
  float widest;     // half-angle past which a bundle is loose
  PUSH_LIST
} push;
layout(constant_id = SPEC_LANES) const uint LANES = 8;  // of a subgroup, which is the workgroup
#include "lanes.glsl"
#include "loose.glsl"

void main() {
  uint bundle = global_group(), count = counters[COUNT_RAYS + push.kind];
  uint first = bundle * BUNDLE;
  if (first >= count) return;
  uint last = min(first + BUNDLE, count);
  vec3 lo = vec3(INFINITY), hi = vec3(-INFINITY), sum = vec3(0), dlo = vec3(2), dhi = vec3(-2);
  float tmax = 0.0;
  for (uint base = first; base < last; base += LANES) {
    uint i = base + gl_SubgroupInvocationID;
    Ray r = load_ray(push.rays, load_slot(push.order, min(i, last - 1u)));
    lo = min(lo, r.origin);
    hi = max(hi, r.origin);
    dlo = min(dlo, r.direction);
    dhi = max(dhi, r.direction);
    sum += i < last ? r.direction : vec3(0);
    tmax = max(tmax, r.tmax);
  }
  lo = min_lanes(lo);
  hi = max_lanes(hi);
  dlo = min_lanes(dlo);
  dhi = max_lanes(dhi);
  sum = sum_lanes(sum);
  tmax = max_lanes(tmax);
  vec3 centre = 0.5 * lo + 0.5 * hi;
  float size = length(sum);
  vec3 axis = size > 1e-3 ? sum / size : vec3(0, 0, 1);
  // From the box of directions, unit vectors all: |d − axis| bounds the chord, and the angle is 2·asin(chord/2).
  vec3 far_corner = max(abs(dlo - axis), abs(dhi - axis));
  float chord = length(far_corner);
  float angle = size > 1e-3 && chord < 1.4 ? 2.0 * arc(0.5 * chord, sqrt(1.0 - 0.25 * chord * chord)) : 4.0;
  float radius = length(0.5 * (hi - lo));
  bool apart = hi != lo;
  // A direction component that changes sign leaves its slab without bounds: such a bundle would walk half the scene.
  bool mixed = any(lessThan(dlo * dhi, vec3(0))) && angle > 0.25 * push.widest;
  bool loose = angle > push.widest || mixed || last - first < 8u;
  if (gl_SubgroupInvocationID != 0u) return;
  uint at = bundle * RAY_NODE_WORDS;
  ray_nodes[at] = centre.x;
  ray_nodes[at + 1u] = centre.y;
  ray_nodes[at + 2u] = centre.z;
  ray_nodes[at + 3u] = apart ? radius * (1.0 + PAD) + PAD * max(max(abs(centre.x), abs(centre.y)), abs(centre.z)) + LEAST : 0.0;
  ray_nodes[at + 4u] = axis.x;
  ray_nodes[at + 5u] = axis.y;
  ray_nodes[at + 6u] = axis.z;
  ray_nodes[at + 7u] = angle * (1.0 + PAD) + PAD + (loose ? LOOSE_ANGLE : 0.0);
  ray_nodes[at + 8u] = tmax;
  if (loose) goes_alone(bundle);
}
