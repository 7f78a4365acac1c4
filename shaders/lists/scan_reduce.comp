// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
#define COMPUTE
#include "lib/common.glsl"
#include "lists/scan_elements.glsl"
#include "lists/scan.glsl"

void main() {
  uint block = global_group(), count = scan_count();
  uint first = block * SCAN_BLOCK + local_index() * RUN;
  uint sum = 0u;
  for (uint i = first; i < min(first + RUN, count); ++i) sum = scan_join(sum, scan_load(i));
  uint total;
  scan_workgroup(sum, total);
  if (local_index() == 0u && block * SCAN_BLOCK < count) block_sums[block] = total;
}
