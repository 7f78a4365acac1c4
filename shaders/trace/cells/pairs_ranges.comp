// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// Pairs lie in the order of their cells: where each cell's begin and end.
#define COMPUTE
#include "lib/common.glsl"
#include "interface/push/cells.h"
#include "lib/push.glsl"
#include "lists/rays.glsl"
#include "lib/counters.glsl"
BUFFER(ROLE_PAIRS, readonly, uvec2, pairs);
BUFFER(ROLE_LISTS, writeonly, uvec2, lists);
PUSH(PairsRangesPush);

void main() {
  uint i = global_index(), half_read = counters[COUNT_PAIR_HALF], count = counters[COUNT_PAIR_HALVES + half_read];
  if (i >= count) return;
  uint at = half_read * push.room, cell = pairs[at + i].x;
  if (i == 0u || pairs[at + i - 1u].x != cell) lists[cell].x = i;
  if (i + 1u == count || pairs[at + i + 1u].x != cell) lists[cell].y = i + 1u;
}
