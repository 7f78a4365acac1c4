// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// Bounds of this batch's origins, over which hash lays its grid. Minima and maxima have no order, so neither has the
// result.
#define COMPUTE
#include "lib/common.glsl"
#include "interface/push/lists.h"
#include "lib/push.glsl"
#extension GL_KHR_shader_subgroup_arithmetic : require
#include "lists/rays.glsl"
#include "lib/counters.glsl"
#include "lib/curves.glsl"
PUSH(BoundsPush);

void main() {
  if (push.reset != 0u) {
    if (local_index() < 6u) counters[COUNT_BOUNDS + local_index()] = local_index() < 3u ? 0xFFFFFFFFu : 0u;
    return;
  }
  uint count = counters[COUNT_RAYS + push.kind];
  uint block = global_group() * SCAN_BLOCK + local_index() * SCAN_RUN;
  vec3 lo = vec3(INFINITY), hi = vec3(-INFINITY);
  for (uint i = block; i < min(block + SCAN_RUN, count); ++i) {
    vec3 o = load_ray(ray_list.rays, load_slot(ray_list.order, i)).origin;
    lo = min(lo, o);
    hi = max(hi, o);
  }
  lo = subgroupMin(lo);
  hi = subgroupMax(hi);
  if (subgroupElect())
    for (uint axis = 0u; axis < 3u; ++axis) {
      atomicMin(counters[COUNT_BOUNDS + axis], ordered(lo[axis]));
      atomicMax(counters[COUNT_BOUNDS + 3u + axis], ordered(hi[axis]));
    }
}
