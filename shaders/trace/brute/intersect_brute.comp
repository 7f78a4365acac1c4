// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// Strategy `brute`: every ray against every triangle, the N × M of R 5.2 and the oracle on the device. In slices of the
// triangles, so that no dispatch runs for minutes.
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
PUSH(IntersectBrutePush);

void main() {
  uint i = global_index();
  if (i >= counters[COUNT_RAYS + push.kind]) return;
  uint slot = load_slot(ray_list.order, i);
  Ray ray = load_ray(ray_list.rays, slot);
  Shear s = make_shear(ray.origin, ray.direction);
  Nearest best = Nearest(ray.tmax, NO_INDEX);
  Shade shade = Shade(false, NO_INDEX, 0.0, ivec3(0));
  if (push.first > 0u) {  // go on from the slices before
    uint64_t found = hit_at(ray_list.hits, slot).v;
    shade.blocked = found != NO_HIT;
    if (found != NO_HIT) {
      best = Nearest(uintBitsToFloat(uint(found >> 32)), uint(found));
      shade.triangle = best.triangle;
      shade.t = best.t;
    }
    if (ANY_HIT && TRANSLUCENT)
      for (uint c = 0u; c < 3u; ++c) shade.optical_depth[c] = optical_depth[3u * slot + c];
  }
  Pending pending = NOTHING_PENDING;
  uint tests = 0u;
  for (uint t = push.first; t < push.last && !(ANY_HIT && shade.blocked); ++t) {
    ++tests;
    if (ANY_HIT) {
      consider_shadow(t, s, ray.tmin, ray.tmax, shade, pending);
      if (TRANSLUCENT) settle_shadow(ray.direction, ray.tmax, shade, pending);
    } else {
      consider_nearest(t, s, ray.tmin, best, pending);
      if (MASKED) settle_nearest(best, pending);
    }
  }
  if (ANY_HIT)
    store_shade(ray_list.hits, slot, shade);
  else
    store_nearest(ray_list.hits, slot, best);
  count_tests(push.kind, STAT_RAY_TRIANGLE, tests);
  count_pixel(load_ray_pixel(ray_list.rays, slot), tests);
}
