// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// Traverse and intersect for `hybrid`: one subgroup walks the object hierarchy with a bundle of rays (bundle_rays.glsl). Lanes
// are a node's children when boxes are tested.
//
// Exact: see beam.glsl; the cone test is padded. Control flow as in single_ray.glsl.
#define COMPUTE
#include "common.glsl"
#extension GL_EXT_control_flow_attributes : require
#include "rays.glsl"
#include "scene.glsl"
#include "candidate.glsl"
#include "results.glsl"
#include "lists.glsl"
#include "args.glsl"
#include "counting.glsl"
#include "ray_node.glsl"
#include "visit.glsl"
#include "beam.glsl"
BUFFER(ROLE_RAY_NODES, readonly, float, ray_nodes);
BUFFER(ROLE_WORK, writeonly, uint, work);
layout(push_constant) uniform Push {
  uint kind;
  uint most_effort;
  PUSH_LIST
} push;

#include "bundle_rays.glsl"
#include "visit_together.glsl"
#include "loose.glsl"

Visit visit;  // the same in all lanes

// Children that some ray of the bundle may enter, a bit each.
uint entered_children(Beam beam, Cone cone, uint node) {
  Boxes boxes = load_boxes_together(node);
  uint entered = 0u;
  for (uint base = 0u; base < WIDE; base += LANES) {
    uint c = base + lane;
    vec3 lo, hi;
    child_box(boxes, c & 7u, lo, hi);
    bool there = c < WIDE && (boxes.grid.there & (1u << c)) != 0u;
    if (there) ++node_tests;
    bool enters = there && beam_enters(beam, lo, hi) && cone_meets_sphere(cone, 0.5 * lo + 0.5 * hi, 0.5 * length(hi - lo));
    entered |= lanes_where(enters) << base;
  }
  return entered;
}

void walk(Beam beam, Cone cone) {
  uint current = 0u, place = 0u;
  while (current != CHILD_EMPTY) {
    while (current != CHILD_EMPTY && waiting_has_room()) {
      while (is_node(current)) {
        if (++effort > push.most_effort) return;
        visit_together(visit, current, entered_children(beam, cone, current) & 255u);
        current = next_together(visit, place);
      }
      while (!is_node(current) && current != CHILD_EMPTY && waiting_has_room()) {
        test_leaf(current, place);
        beam.farthest = farthest_hit();
        current = next_together(visit, place);
        if (!(beam.farthest > -INFINITY)) current = CHILD_EMPTY;  // every shadow ray is blocked
      }
    }
    settle_waiting();
    beam.farthest = farthest_hit();
    if (!(beam.farthest > -INFINITY)) current = CHILD_EMPTY;
  }
}

void main() {
  uint rays_here = counters[COUNT_RAYS + push.kind], bundle = global_group();
  first_ray = bundle * BUNDLE;
  if (first_ray >= rays_here) return;
  RayNode node = LOAD_RAY_NODE(ray_nodes, bundle * RAY_NODE_WORDS);
  if (node.angle >= LOOSE_ANGLE) return;
  lane = gl_SubgroupInvocationID;
  ray_count = min(BUNDLE, rays_here - first_ray);
  visit = Visit(0u, 0u, octant_of(node.axis));
  Beam beam = load_bundle();
  walk(beam, cone_of(node));
  if (effort > push.most_effort) {  // what it found is found again
    if (lane == 0u) goes_alone(bundle);
  } else
    [[dont_unroll]] for (uint v = 0u; v < vectors; ++v) store(v);
  count_tests(push.kind, STAT_NODE_OBJECT, node_tests);
  count_tests(push.kind, STAT_LEVELS + 3u, node_tests);
  count_tests(push.kind, STAT_RAY_BOX, box_tests);
  count_tests(push.kind, STAT_RAY_TRIANGLE, triangle_tests);
}
