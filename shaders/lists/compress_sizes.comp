// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// Sizes of the chunks: to the next chunk's base, or to the end.
#define COMPUTE
#include "lib/common.glsl"
#include "interface/push/push.h"
#include "lib/push.glsl"
#include "lib/counters.glsl"
BUFFER(ROLE_CHUNKS, coherent, uvec3, chunks);  // key, base, size
PUSH(KindPush);

void main() {
  uint count = counters[COUNT_CHUNKS];
  uint first = global_group() * SCAN_BLOCK + local_index() * SCAN_RUN;
  for (uint i = first; i < min(first + SCAN_RUN, count); ++i)
    chunks[i].z = (i + 1u < count ? chunks[i + 1u].y : counters[COUNT_RAYS + push.kind]) - chunks[i].y;
}
