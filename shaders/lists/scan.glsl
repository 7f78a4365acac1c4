// SPDX-License-Identifier: MIT
// Scans in three passes: reduce (a sum a block), spine (one workgroup scans the sums), scatter (each block again, now
// with its offset). A block is SCAN_GROUP invocations with SCAN_RUN consecutive elements each: on a CPU device a serial
// run costs about 1 ns an element, a workgroup barrier 5 to 10 ns an invocation, so runs are long and barriers few. The
// element is a (head, value) pair for the segmented scan, with (f1,v1)·(f2,v2) = (f1|f2, f2 ? v2 : v1+v2); for plain
// sums the head bit is never set. Packed: bit 31 = head, the rest the value, so values stay below 2^31.
#ifndef SHEAF_SCAN_GLSL
#define SHEAF_SCAN_GLSL
BUFFER(ROLE_BLOCK_SUMS, coherent, uint, block_sums);
shared uint scan_shared[SCAN_GROUP];

const uint SCAN_HEAD = 0x80000000u;
uint scan_join(uint left, uint right) {
  return (right & SCAN_HEAD) != 0u ? right : (left & SCAN_HEAD) | ((left & ~SCAN_HEAD) + right);
}

// What lies before this invocation in its workgroup, and (out) the whole workgroup's.
uint scan_workgroup(uint own, out uint total) {
  scan_shared[local_index()] = own;
  barrier();
  uint before = 0u;
  for (uint i = 0u; i < local_index(); ++i) before = scan_join(before, scan_shared[i]);
  total = before;
  for (uint i = local_index(); i < SCAN_GROUP; ++i) total = scan_join(total, scan_shared[i]);
  barrier();
  return before;
}
#endif
