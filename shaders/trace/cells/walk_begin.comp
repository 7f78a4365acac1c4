// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// A walk of some cells through the object hierarchy begins: as many pairs (cell, root) as cells, if there is room.
#define COMPUTE
#include "lib/common.glsl"
#include "interface/push/cells.h"
#include "lib/push.glsl"
#include "lists/rays.glsl"
#include "lib/counters.glsl"
#include "lib/args.glsl"
PUSH(WalkBeginPush);

void main() {
  if (local_index() != 0u) return;
  uint all = counters[COUNT_CELLS], cells = push.first < all ? min(push.most, all - push.first) : 0u;
  bool fits = cells <= push.room;
  counters[COUNT_WALK_FIRST] = push.first;
  counters[COUNT_WALK_CELLS] = fits ? cells : 0u;
  counters[COUNT_WALK_OVERFLOW] = fits ? 0u : 1u;
  counters[COUNT_PAIR_HALVES] = fits ? cells : 0u;
  counters[COUNT_PAIR_HALF] = 0u;
  counters[COUNT_OPEN] = 0u;
  set_args(ARGS_WALK_RUNS, fits ? groups_of(cells, GROUP) : 0u);
  set_args(ARGS_WALK_CELLS, fits ? cells : 0u);
  set_args(ARGS_PAIRS, fits ? groups_of(cells, GROUP) : 0u);
  set_args(ARGS_PAIR_BLOCKS, fits ? groups_of(cells, SCAN_BLOCK) : 0u);
  set_args(ARGS_PAIR_RANGES, fits ? groups_of(cells, GROUP) : 0u);
  set_args(ARGS_PAIR_SCATTER, 0u);
}
