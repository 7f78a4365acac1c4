// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// Traverse and intersect for `bvh`, and for what `hybrid` finds too wide to walk as a bundle: one ray per lane, or
// (PACKETS) first by the packet.
#define COMPUTE
#include "lib/common.glsl"
#include "interface/push/trace.h"
#include "lib/push.glsl"
#include "lists/rays.glsl"
#include "scene/scene.glsl"
#include "trace/common/candidate.glsl"
#include "trace/common/results.glsl"
#include "lib/counters.glsl"
#include "lib/counting.glsl"
#include "trace/single/single_ray.glsl"
BUFFER(ROLE_INCOHERENT_BUNDLES, readonly, uint, incoherent_bundles);
layout(constant_id = SPEC_INCOHERENT) const bool INCOHERENT = false;

PUSH(TraverseSinglePush);

void main() {
  uint i = global_index();
  if (INCOHERENT) {
    if (global_group() >= counters[COUNT_INCOHERENT]) return;
    i = incoherent_bundles[global_group()] * gl_WorkGroupSize.x + local_index();
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
  uint slot = load_slot(ray_list.order, is_active ? i : last - 1u);
  Ray ray = load_ray(ray_list.rays, slot);
  Nearest best = Nearest(is_active ? ray.tmax : -INFINITY, NO_INDEX);
  Shade shade = Shade(false, NO_INDEX, 0.0, ivec3(0));
  Tests tests = Tests(0u, 0u);
  trace_single(ray, best, shade, tests);
  if (!is_active) return;
  if (ANY_HIT)
    store_shade(ray_list.hits, slot, shade);
  else
    store_nearest(ray_list.hits, slot, best);
  count_tests(push.kind, STAT_RAY_BOX, tests.boxes);
  count_tests(push.kind, STAT_RAY_TRIANGLE, tests.triangles);
  count_pixel(load_ray_pixel(ray_list.rays, slot), tests.boxes + tests.triangles);
}
