// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
#define COMPUTE
#include "lib/common.glsl"
#include "lists/sort.glsl"

void main() {
  uint block = global_group(), count = counters[COUNT_CHUNKS];
  uint first = block * SCAN_BLOCK + local_index() * SCAN_RUN;
  count_own_digits(first, min(first + SCAN_RUN, count));
  uint d = local_index();
  if (d >= RADIX || block >= block_count()) return;
  uint sum = 0u;
  for (uint i = 0u; i < SCAN_GROUP; ++i) sum += own_counts[d * SCAN_GROUP + i];
  digit_counts[d * block_count() + block] = sum;
}
