// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// The beams of cells: the frustums of the rays that are in them, one subgroup a cell. Tighter than the cells' own
// beams, and like them a bound of every ray; a cell's rays have one face. A cell that was not divided keeps the one it
// had.
#define COMPUTE
#include "lib/common.glsl"
#include "interface/push/cells.h"
#include "lib/push.glsl"
#include "lists/rays.glsl"
#include "lib/counters.glsl"
#include "scene/node.glsl"
#include "scene/triangle.glsl"
#include "trace/cells/frustum_memory.glsl"
#include "scene/hierarchy_box.glsl"
#include "lib/lanes.glsl"
BUFFER(ROLE_CELLS, readonly, uvec2, cells_above);
BUFFER(ROLE_CELLS_NEXT, readonly, uvec2, cells);
PUSH(ClassifyFrustumsPush);

vec4 min_lanes(vec4 v) { return vec4(min_lanes(v.xyz), min_lanes(v.w)); }
vec4 max_lanes(vec4 v) { return vec4(max_lanes(v.xyz), max_lanes(v.w)); }

// Of a cell that was not divided.
void keep_frustum(uint cell, uint above) {
  Frustum f = load_frustum(push.above, above);
  f.settled = true;
  store_frustum(push.frustums, cell, f);
}

void main() {
  uint cell = global_group();
  if (cell >= counters[COUNT_WALK_CELLS]) return;
  uint first = cells[cell].x, last = cells[cell + 1u].x, above = cells[cell].y, lane = gl_SubgroupInvocationID;
  if (push.above != uvec2(0) && cells_above[above].x == first && cells_above[above + 1u].x == last) {
    if (lane == 0u) keep_frustum(cell, above);
    return;
  }
  vec3 lo, hi;
  hierarchy_box(lo, hi);
  Ray leader = load_ray(ray_list.rays, load_slot(ray_list.order, first));
  Hull hull = begin_hull(leader.direction, lo, hi);
  for (uint k = first + lane; k < last; k += LANES) {
    Ray r = load_ray(ray_list.rays, load_slot(ray_list.order, k));
    add_extent(hull, r.origin, r.direction, r.tmin, r.tmax);
  }
  hull.first = min_lanes(hull.first);
  hull.last = max_lanes(hull.last);
  hull.largest = max_lanes(hull.largest);
  set_planes(hull);
  for (uint k = first + lane; k < last; k += LANES) {
    Ray r = load_ray(ray_list.rays, load_slot(ray_list.order, k));
    add_places(hull, r.origin, r.direction);
  }
  bvec4 upper = bvec4(false, true, false, true);
  hull.near = mix(min_lanes(hull.near), max_lanes(hull.near), upper);
  hull.far = mix(min_lanes(hull.far), max_lanes(hull.far), upper);
  if (lane == 0u) store_frustum(push.frustums, cell, end_hull(hull, octant_of(leader.direction)));
}
