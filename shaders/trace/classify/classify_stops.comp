// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// Which cells are not divided, however many rays they have: those whose candidates are but a few leaves. And which are,
// however few: those with more candidates than rays that keep together have (R 3.2: by candidates as well as by rays).
#define COMPUTE
#include "lib/common.glsl"
#include "interface/hierarchy.h"
#include "interface/push/cells.h"
#include "lib/push.glsl"
#include "lists/rays.glsl"
#include "lib/counters.glsl"
BUFFER(ROLE_LISTS, readonly, uvec2, lists);
BUFFER(ROLE_PAIRS, readonly, uvec2, pairs);
BUFFER(ROLE_CELL_STOPS, writeonly, uint, cell_stops);
PUSH(ClassifyStopsPush);

void main() {
  uint i = global_index();
  if (i >= counters[COUNT_WALK_CELLS]) return;
  uvec2 list = lists[i];
  bool stops = list.y - list.x <= CLASS_FEW;
  if (stops) {
    uint at = counters[COUNT_PAIR_HALF] * push.room;
    for (uint k = list.x; k < list.y; ++k) stops = stops && (pairs[at + k].y & CHILD_LEAF) != 0u;
  }
  cell_stops[i] = stops ? CELL_STOPS : list.y - list.x > push.many ? CELL_CROWDED : 0u;
}
