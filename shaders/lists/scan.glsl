// SPDX-License-Identifier: MIT
// Scans in three passes: reduce (one sum per block), spine (one workgroup scans the sums), scatter (each block again,
// now with its offset). A workgroup takes a block of SCAN_BLOCK elements, and each invocation a run of consecutive
// ones: on a CPU device a serial run costs about 1 ns per element. There a workgroup is one subgroup, which needs no
// barrier: llvmpipe turns a kernel with barriers into coroutines, whose compilation takes four to five times as long
// (0.95 s of a cold start for three kernels). The element is a (head, value) pair for the segmented scan, with
// (f1,v1)·(f2,v2) = (f1|f2, f2 ? v2 : v1+v2); for plain sums the head bit is never set. Packed: bit 31 = head, the rest
// the value, so values stay below 2^31.
#ifndef SHEAF_SCAN_GLSL
#define SHEAF_SCAN_GLSL
#include "interface/bindings.h"
#include "interface/dispatch.h"
#include "lib/common.glsl"
#extension GL_KHR_shader_subgroup_ballot : require
BUFFER(ROLE_BLOCK_SUMS, coherent, uint, block_sums);
shared uint scan_shared[SCAN_GROUP];

const uint SCAN_HEAD = 0x80000000u;
uint scan_join(uint left, uint right) {
  return (right & SCAN_HEAD) != 0u ? right : (left & SCAN_HEAD) | ((left & ~SCAN_HEAD) + right);
}

const uint RUN = SCAN_BLOCK / gl_WorkGroupSize.x;  // elements per invocation

// What lies before this invocation in its workgroup, and (out) the whole workgroup's.
uint scan_workgroup(uint own, out uint total) {
  uint before = 0u;
  total = 0u;
  if (WORKERS > 0u) {
    for (uint i = 0u; i < gl_SubgroupSize; ++i) {
      uint one = subgroupBroadcast(own, i);
      if (i < gl_SubgroupInvocationID) before = scan_join(before, one);
      total = scan_join(total, one);
    }
    return before;
  }
  scan_shared[local_index()] = own;
  barrier();
  for (uint i = 0u; i < local_index(); ++i) before = scan_join(before, scan_shared[i]);
  total = before;
  for (uint i = local_index(); i < gl_WorkGroupSize.x; ++i) total = scan_join(total, scan_shared[i]);
  barrier();
  return before;
}
#endif
