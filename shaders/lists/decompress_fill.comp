// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// The skeleton of ones that chunk bases are then set into (R 4.2, Decompression).
#define COMPUTE
#include "lib/common.glsl"
#include "interface/push/push.h"
#include "lib/push.glsl"
#include "lib/counters.glsl"
BUFFER(ROLE_SKELETON, writeonly, uint, skeleton);
PUSH(KindPush);

void main() {
  uint count = counters[COUNT_RAYS + push.kind];
  uint first = global_group() * SCAN_BLOCK + local_index() * SCAN_RUN;
  for (uint i = first; i < min(first + SCAN_RUN, count); ++i) skeleton[i] = 1u;
}
