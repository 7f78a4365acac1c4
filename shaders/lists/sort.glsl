// SPDX-License-Identifier: MIT
// One pass of a stable least-significant-digit radix sort of the chunks (Satish, Harris, Garland 2009), RADIX_BITS a
// pass: count (a block's digits), spine (where each block's share of a digit starts), scatter. Stable because blocks,
// invocations within a block and elements within an invocation's run all keep their order.
#ifndef SHEAF_SORT_GLSL
#define SHEAF_SORT_GLSL
#include "lib/common.glsl"
#include "interface/push/lists.h"
#include "lib/push.glsl"
#include "lib/counters.glsl"
BUFFER(ROLE_CHUNKS, readonly, uvec3, chunks);
BUFFER(ROLE_CHUNKS_ALT, writeonly, uvec3, chunks_sorted);
BUFFER(ROLE_BLOCK_SUMS, coherent, uint, digit_counts);  // [digit][block]
PUSH(SortPush);
shared uint own_counts[RADIX * SCAN_GROUP];  // [digit][invocation]

uint digit_of(uint i) { return (chunks[i].x >> push.shift) & (RADIX - 1u); }
uint block_count() { return (counters[COUNT_CHUNKS] + SCAN_BLOCK - 1u) / SCAN_BLOCK; }

void count_own_digits(uint first, uint last) {
  for (uint d = 0u; d < RADIX; ++d) own_counts[d * SCAN_GROUP + local_index()] = 0u;
  for (uint i = first; i < last; ++i) ++own_counts[digit_of(i) * SCAN_GROUP + local_index()];
  barrier();
}
#endif
