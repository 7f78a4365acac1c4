// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
#define COMPUTE
#include "lib/common.glsl"
#include "lists/sort.glsl"

void main() {  // one workgroup
  uint entries = RADIX * block_count();
  uint run = (entries + SCAN_GROUP - 1u) / SCAN_GROUP;
  uint first = local_index() * run, last = min(first + run, entries);
  uint sum = 0u;
  for (uint i = first; i < last; ++i) sum += digit_counts[i];
  own_counts[local_index()] = sum;
  barrier();
  uint before = 0u;
  for (uint i = 0u; i < local_index(); ++i) before += own_counts[i];
  for (uint i = first; i < last; ++i) {
    uint own = digit_counts[i];
    digit_counts[i] = before;
    before += own;
  }
}
