// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// Frustum creation (S, R 3.4): one a packet, and its first pair, with the root of the object hierarchy.
#define COMPUTE
#include "lib/common.glsl"
#include "interface/push/cells.h"
#include "lib/push.glsl"
#include "lists/rays.glsl"
#include "lib/counters.glsl"
#include "scene/node.glsl"
#include "scene/triangle.glsl"
#include "trace/cells/frustum_memory.glsl"
BUFFER(ROLE_PACKETS, readonly, uvec2, packets);  // first ray, cell; one more at the end
BUFFER(ROLE_PAIRS, writeonly, uvec2, pairs);
PUSH(PacketsFrustumsPush);
#include "scene/hierarchy_box.glsl"

void main() {
  uint i = global_index();
  if (i >= counters[COUNT_WALK_CELLS]) return;
  uint packet = counters[COUNT_WALK_FIRST] + i, first = packets[packet].x, last = packets[packet + 1u].x;
  vec3 lo, hi;
  hierarchy_box(lo, hi);
  Ray leader = load_ray(ray_list.rays, load_slot(ray_list.order, first));
  Hull hull = begin_hull(leader.direction, lo, hi);
  for (uint k = first; k < last; ++k) {
    Ray r = load_ray(ray_list.rays, load_slot(ray_list.order, k));
    add_extent(hull, r.origin, r.direction, r.tmin, r.tmax);
  }
  set_planes(hull);
  for (uint k = first; k < last; ++k) {
    Ray r = load_ray(ray_list.rays, load_slot(ray_list.order, k));
    add_places(hull, r.origin, r.direction);
  }
  store_frustum(push.frustums, i, end_hull(hull, octant_of(leader.direction)));
  pairs[i] = uvec2(i, 0u);
}
