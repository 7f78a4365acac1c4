// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// Candidate sets are made anew (R 3.1): every new cell takes over the candidates of the cell above, one workgroup a
// cell; the next level of the walk tests them against its own beam.
#define COMPUTE
#include "lib/common.glsl"
#include "interface/push/cells.h"
#include "lib/push.glsl"
#include "lists/rays.glsl"
#include "lib/counters.glsl"
BUFFER(ROLE_CELLS_NEXT, readonly, uvec2, cells);
BUFFER(ROLE_LISTS, readonly, uvec2, lists);               // of the cells above
BUFFER(ROLE_CELL_OFFSETS, readonly, uint, cell_offsets);  // candidates before the cell's
BUFFER(ROLE_PAIRS, coherent, uvec2, pairs);
PUSH(ClassifyCandidatesPush);

void main() {
  uint cell = global_group();
  if (cell >= counters[COUNT_WALK_CELLS]) return;
  uint half_read = 1u - counters[COUNT_PAIR_HALF], lane = local_index();
  uint to = counters[COUNT_PAIR_HALF] * push.room + cell_offsets[cell];
  if (push.root != 0u) {
    if (lane == 0u) pairs[to] = uvec2(cell, 0u);
    return;
  }
  uvec2 list = lists[cells[cell].y];
  for (uint k = list.x + lane; k < list.y; k += gl_WorkGroupSize.x)
    pairs[to + k - list.x] = uvec2(cell, pairs[half_read * push.room + k].y);
}
