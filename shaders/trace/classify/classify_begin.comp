// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// A walk of some rays, sorted by class, begins: one cell holds them all, the root of the object hierarchy is its
// candidate.
#define COMPUTE
#include "lib/common.glsl"
#include "interface/push/cells.h"
#include "lib/push.glsl"
#include "lists/rays.glsl"
#include "lib/counters.glsl"
#include "lib/args.glsl"
BUFFER(ROLE_CELLS, writeonly, uvec2, cells);       // first ray, cell above; the walk's end follows the last
BUFFER(ROLE_CELL_STOPS, writeonly, uint, cell_stops);
PUSH(ClassifyBeginPush);

void main() {
  if (local_index() != 0u) return;
  uint all = counters[COUNT_RAYS + push.kind], rays_here = push.first < all ? min(push.most, all - push.first) : 0u;
  counters[COUNT_WALK_FIRST] = 0u;
  counters[COUNT_WALK_RAY] = push.first;
  counters[COUNT_WALK_RAYS] = rays_here;
  counters[COUNT_WALK_CELLS] = min(rays_here, 1u);
  counters[COUNT_WALK_OVERFLOW] = 0u;
  counters[COUNT_PAIR_HALF] = 0u;
  counters[COUNT_PAIR_HALVES] = 0u;
  counters[COUNT_OPEN] = 0u;
  cells[0] = uvec2(push.first, 0u);
  cells[1] = uvec2(push.first + rays_here, 0u);
  cell_stops[0] = 0u;
  set_args(ARGS_WALK_BLOCKS, groups_of(rays_here, SCAN_BLOCK));
}
