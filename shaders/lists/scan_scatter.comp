// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
#define COMPUTE
#include "lib/common.glsl"
#include "lists/scan_elements.glsl"
#include "lists/scan.glsl"

void main() {
  uint block = global_group(), count = scan_count();
  uint first = block * SCAN_BLOCK + local_index() * RUN, last = min(first + RUN, count);
  uint sum = 0u;
  for (uint i = first; i < last; ++i) sum = scan_join(sum, scan_load(i));
  uint total;
  uint before = scan_workgroup(sum, total);
  if (block * SCAN_BLOCK < count) before = scan_join(block_sums[block], before);
  for (uint i = first; i < last; ++i) {
    uint own = scan_load(i);
#ifdef SCAN_INCLUSIVE
    before = scan_join(before, own);
    scan_store(i, before, own);
#else
    scan_store(i, before, own);
    before = scan_join(before, own);
#endif
  }
}
