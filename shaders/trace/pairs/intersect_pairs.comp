// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// Local intersection tests (R 4.5): what is left is (ray, triangle). Many pairs of one ray run at once; the nearest is
// a 64-bit minimum of (t, triangle), optical depths are integer sums, so the order of the pairs does not show.
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
BUFFER(ROLE_PAIRS, readonly, uvec2, pairs);
PUSH(IntersectPairsPush);

void main() {
  uint i = global_index();
  if (push.reset != 0u) {
    if (i >= counters[COUNT_RAYS + push.kind]) return;
    uint slot = load_slot(ray_list.order, i);
    hit_at(ray_list.hits, slot).v = NO_HIT;
    if (ANY_HIT && TRANSLUCENT)
      for (uint c = 0u; c < 3u; ++c) optical_depth[3u * slot + c] = 0;
    return;
  }
  if (i >= push.pairs) return;
  uvec2 pair = pairs[i];
  uint slot = load_slot(ray_list.order, pair.x);
  uint64_t known = hit_at(ray_list.hits, slot).v;
  if (ANY_HIT && known != NO_HIT) return;  // blocked already: no test
  Ray ray = load_ray(ray_list.rays, slot);
  Shear s = make_shear(ray.origin, ray.direction);
  Pending pending = NOTHING_PENDING;
  if (ANY_HIT) {
    Shade shade = Shade(false, NO_INDEX, 0.0, ivec3(0));
    consider_shadow(pair.y, s, ray.tmin, ray.tmax, shade, pending);
    if (TRANSLUCENT) settle_shadow(ray.direction, ray.tmax, shade, pending);
    if (shade.blocked) atomicMin(hit_at(ray_list.hits, slot).v, pack_hit(shade.t, shade.triangle));
    if (TRANSLUCENT)
      for (uint c = 0u; c < 3u; ++c)
        if (shade.optical_depth[c] != 0) atomicAdd(optical_depth[3u * slot + c], shade.optical_depth[c]);
  } else {
    Nearest best = Nearest(ray.tmax, NO_INDEX);
    consider_nearest(pair.y, s, ray.tmin, best, pending);
    if (MASKED) settle_nearest(best, pending);
    if (best.triangle != NO_INDEX) atomicMin(hit_at(ray_list.hits, slot).v, pack_hit(best.t, best.triangle));
  }
  count_tests(push.kind, STAT_RAY_TRIANGLE, 1u);
  count_pixel(load_ray_pixel(ray_list.rays, slot), 1u);
}
