// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// Before each generate: how many parents there are, how many slots their rays need, and whether those fit. A band that
// does not fit stops here, says so, and is cut in two by the host: nothing is dropped.
#define COMPUTE
#include "lib/common.glsl"
#include "interface/push/shade.h"
#include "lib/push.glsl"
#include "lists/rays.glsl"
#include "lib/counters.glsl"
#include "lib/args.glsl"
BUFFER(ROLE_STATS, coherent, uint64_t, stats);
PUSH(GenerateBeginPush);

void main() {
  if (local_index() != 0u) return;
  if (push.direct != 0u) {
    counters[COUNT_RAYS + KIND_PRIMARY] = frame.batch_rays;
    stats[KIND_PRIMARY * STAT_FIELDS + STAT_RAYS] += uint64_t(frame.batch_rays);
  }
  uint first = push.primary != 0u ? counters[COUNT_RAYS + KIND_PRIMARY] : counters[COUNT_RAYS + KIND_REFLECTION];
  uint second = push.primary != 0u ? 0u : counters[COUNT_RAYS + KIND_REFRACTION];
  uint parents = first + second;
  uint64_t needed = uint64_t(parents) * uint64_t(max(frame.lights, 1u));
  if (needed > uint64_t(frame.capacity)) {
    counters[COUNT_OVERFLOW] = 1u;
    parents = first = second = 0u;
    counters[COUNT_RAYS + KIND_REFLECTION] = counters[COUNT_RAYS + KIND_REFRACTION] = 0u;
    counters[COUNT_RAYS + KIND_PRIMARY] = 0u;
  }
  counters[COUNT_PARENTS] = parents;
  counters[COUNT_SLOTS + KIND_REFLECTION] = counters[COUNT_SLOTS + KIND_REFRACTION] = parents;
  counters[COUNT_SLOTS + KIND_SHADOW] = parents * frame.lights;
  set_args(ARGS_PARENTS, groups_of(first, GROUP));
  set_args(ARGS_PARENTS_REFRACTION, groups_of(second, GROUP));
  set_args(ARGS_SLOTS, groups_of(parents, SCAN_BLOCK));
  set_args(ARGS_SLOTS_SHADOW, groups_of(parents * frame.lights, SCAN_BLOCK));
}
