// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// One workgroup turns the blocks' sums into what lies before each block; runs grow with the number of blocks.
#define COMPUTE
#include "lib/common.glsl"
#include "lists/scan_elements.glsl"
#include "lists/scan.glsl"

void main() {
  uint blocks = groups_of(scan_count(), SCAN_BLOCK);
  uint run = groups_of(blocks, gl_WorkGroupSize.x);
  uint first = local_index() * run, last = min(first + run, blocks);
  uint sum = 0u;
  for (uint i = first; i < last; ++i) sum = scan_join(sum, block_sums[i]);
  uint total;
  uint before = scan_workgroup(sum, total);
  for (uint i = first; i < last; ++i) {
    uint own = block_sums[i];
    block_sums[i] = before;
    before = scan_join(before, own);
  }
  if (local_index() == 0u) scan_total(total);
}
