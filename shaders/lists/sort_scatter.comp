// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
#define COMPUTE
#include "lib/common.glsl"
#include "lists/sort.glsl"

void main() {
  uint block = global_group(), count = counters[COUNT_CHUNKS];
  uint first = block * SCAN_BLOCK + local_index() * SCAN_RUN, last = min(first + SCAN_RUN, count);
  count_own_digits(first, last);
  uint d = local_index();
  if (d < RADIX && block < block_count()) {  // counts become places
    uint at = digit_counts[d * block_count() + block];
    for (uint i = 0u; i < SCAN_GROUP; ++i) {
      uint own = own_counts[d * SCAN_GROUP + i];
      own_counts[d * SCAN_GROUP + i] = at;
      at += own;
    }
  }
  barrier();
  for (uint i = first; i < last; ++i) {
    uint cell = digit_of(i) * SCAN_GROUP + local_index();
    chunks_sorted[own_counts[cell]++] = chunks[i];
  }
}
