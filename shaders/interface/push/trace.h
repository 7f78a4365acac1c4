// SPDX-License-Identifier: MIT
// Push constants: rays_hierarchy and the strategies without cells. traverse_query needs only the kind.
#ifndef SHEAF_PUSH_TRACE_H
#define SHEAF_PUSH_TRACE_H
#include "interface/push/push.h"
SHEAF_INTERFACE_BEGIN

// rays_hierarchy
struct RaysHierarchyPush {
  uint kind;
  uint level;  // being made, 1 and up
  uint first;  // word of this level's first node
  uint first_below;  // word of the level below; unused for level 1
};
SHEAF_PUSH(RaysHierarchyPush, 4)

// traverse_single, traverse_packets
struct TraverseSinglePush {
  uint kind;
  uint first;  // of the list's rays
  uint count;  // 0: all
};
SHEAF_PUSH(TraverseSinglePush, 3)

// traverse_bundles
struct TraverseBundlesPush {
  uint kind;
  uint most_effort;
  float widest;  // half-angle past which a bundle is incoherent
};
SHEAF_PUSH(TraverseBundlesPush, 3)

// traverse_pairs
struct TraversePairsPush {
  uint kind;
  uint level;  // of the nodes being tested; 0: rays
  uint first_word;  // of this level's nodes
  uint nodes;  // on this level
  uint candidates;  // in this batch
  uint offset;  // first parent, or first candidate among the seeds
  uint seeds;  // not 0: so many seeds
  uint opens_parts;  // 1: parents are opened into triangles, not into the nodes below
};
SHEAF_PUSH(TraversePairsPush, 8)

// intersect_pairs
struct IntersectPairsPush {
  uint kind;
  uint pairs;
  uint reset;  // 1: mark every ray of the list as without a hit instead
};
SHEAF_PUSH(IntersectPairsPush, 3)

// intersect_brute
struct IntersectBrutePush {
  uint kind;
  uint first;  // triangle
  uint last;
};
SHEAF_PUSH(IntersectBrutePush, 3)

SHEAF_INTERFACE_END
#endif
