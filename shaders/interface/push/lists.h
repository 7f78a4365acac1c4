// SPDX-License-Identifier: MIT
// Push constants: hash and sort. Scans of lists and compression need only the kind (KindPush).
#ifndef SHEAF_PUSH_LISTS_H
#define SHEAF_PUSH_LISTS_H
#include "interface/push/push.h"
SHEAF_INTERFACE_BEGIN

// hash_bounds, classify_bounds
struct BoundsPush {
  uint kind;
  uint reset;  // 1: the bounds are emptied instead
};
SHEAF_PUSH(BoundsPush, 2)

// hash
struct HashPush {
  uint kind;
  uint bits;  // per coordinate
  uint light_bits;
};
SHEAF_PUSH(HashPush, 3)

// sort_count, sort_spine, sort_scatter
struct SortPush {
  uint shift;  // of the digit
};
SHEAF_PUSH(SortPush, 1)

SHEAF_INTERFACE_END
#endif
