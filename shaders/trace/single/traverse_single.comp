// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// Traverse and intersect for `bvh`, and for what `hybrid` finds too wide to walk as a bundle: one ray per lane, or
// (PACKETS) first by the packet.
#define COMPUTE
#include "lib/common.glsl"
#extension GL_EXT_control_flow_attributes : require
#include "lists/rays.glsl"
#include "scene/scene.glsl"
#include "trace/common/candidate.glsl"
#include "trace/common/results.glsl"
#include "lib/counters.glsl"
#include "lib/counting.glsl"
#include "trace/single/single_ray.glsl"
BUFFER(ROLE_WORK, readonly, uint, work);
layout(constant_id = SPEC_INCOHERENT) const bool INCOHERENT = false;

layout(push_constant) uniform Push {
  uint kind;
  uint first, count;  // of the list's rays; 0: all
  PUSH_LIST
} push;

void main() {
  uint i = global_index();
  if (INCOHERENT) {
    if (global_group() >= counters[COUNT_INCOHERENT]) return;
    i = work[global_group()] * gl_WorkGroupSize.x + local_index();
  }
  uint last = counters[COUNT_RAYS + push.kind];
  bool is_active = true;
  if (push.count != 0u) {
    is_active = i < push.count;
    i += push.first;
  }
  is_active = is_active && i < last;
#ifdef PACKETS  // whose lanes all stay: one without a ray finds nothing
  if (!any_lane(is_active)) return;
#else
  if (!is_active) return;
#endif
  uint slot = load_slot(push.order, is_active ? i : last - 1u);
  Ray ray = load_ray(push.rays, slot);
  Nearest best = Nearest(is_active ? ray.tmax : -INFINITY, NO_INDEX);
  Shade shade = Shade(false, NO_INDEX, 0.0, ivec3(0));
  Tests tests = Tests(0u, 0u);
  trace_single(ray, best, shade, tests);
  if (!is_active) return;
  if (ANY_HIT)
    store_shade(push.hits, slot, shade);
  else
    store_nearest(push.hits, slot, best);
  count_tests(push.kind, STAT_RAY_BOX, tests.boxes);
  count_tests(push.kind, STAT_RAY_TRIANGLE, tests.triangles);
  count_pixel(load_ray_pixel(push.rays, slot), tests.boxes + tests.triangles);
}
