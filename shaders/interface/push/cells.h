// SPDX-License-Identifier: MIT
// Push constants: the walk of cells, `frustum` and `classify`.
#ifndef SHEAF_PUSH_CELLS_H
#define SHEAF_PUSH_CELLS_H
#include "interface/push/push.h"
SHEAF_INTERFACE_BEGIN

// walk_begin
struct WalkBeginPush {
  uint first;  // cell
  uint most;  // cells
  uint room;  // for cells
};
SHEAF_PUSH(WalkBeginPush, 3)

// pairs_open
struct PairsOpenPush {
  DeviceAddress frustums;
  uint kind;
  uint half_read;
  uint room;  // pairs of a half
  uint level;  // of the object hierarchy, root 0
  uint ray_level;  // of the cells, for the stats
  uint leaves;  // 1: pairs with leaves are tested too
};
SHEAF_PUSH(PairsOpenPush, 8)

// scan of the children that pairs entered
struct OpenScanPush {
  uint half_read;
  uint room;
  uint always;  // 1: the other half is written also where no pair has a node
};
SHEAF_PUSH(OpenScanPush, 3)

// pairs_ranges
struct PairsRangesPush {
  uint room;
};
SHEAF_PUSH(PairsRangesPush, 1)

// intersect_packets
struct IntersectPacketsPush {
  uint kind;
  uint room;  // pairs of a half
  uint level;  // past the object hierarchy's
};
SHEAF_PUSH(IntersectPacketsPush, 3)

// packets_keys
struct PacketsKeysPush {
  uint kind;
  uint dropped;  // bits of the hash; 32: no hash
};
SHEAF_PUSH(PacketsKeysPush, 2)

// packets_frustums
struct PacketsFrustumsPush {
  DeviceAddress frustums;
};
SHEAF_PUSH(PacketsFrustumsPush, 2)

// classify_begin
struct ClassifyBeginPush {
  uint kind;
  uint first;  // ray
  uint most;  // rays
};
SHEAF_PUSH(ClassifyBeginPush, 3)

// classify_keys
struct ClassifyKeysPush {
  uint kind;
  uint sorted;
};
SHEAF_PUSH(ClassifyKeysPush, 2)

// classify_frustums
struct ClassifyFrustumsPush {
  DeviceAddress frustums;
  DeviceAddress above;  // of the cells above; none have them in the first round
};
SHEAF_PUSH(ClassifyFrustumsPush, 4)

// classify_stops
struct ClassifyStopsPush {
  uint room;
  uint many;  // candidates: a cell with more is crowded
};
SHEAF_PUSH(ClassifyStopsPush, 2)

// classify_candidates
struct ClassifyCandidatesPush {
  uint room;
  uint root;  // 1: there is no cell above, and the candidate is the root
};
SHEAF_PUSH(ClassifyCandidatesPush, 2)

// scan of the rays that begin a cell
struct DivideScanPush {
  uint halvings;  // this division's and those before
  uint first;  // 1: one cell above holds all rays
  uint room;
};
SHEAF_PUSH(DivideScanPush, 3)

// scan of the candidates that new cells take over
struct CandidatesScanPush {
  uint half_read;
  uint room;
  uint root;  // 1: the root alone
};
SHEAF_PUSH(CandidatesScanPush, 3)

SHEAF_INTERFACE_END
#endif
