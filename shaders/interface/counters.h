// SPDX-License-Identifier: MIT
// Counters and statistics that the device writes.
#ifndef SHEAF_INTERFACE_COUNTERS_H
#define SHEAF_INTERFACE_COUNTERS_H
#include "interface/types.h"
SHEAF_INTERFACE_BEGIN

// Counters written by the device; one block, cleared at the start of a band.
SHEAF_CONST COUNT_PARENTS = 0u;       // rays whose hits the next generate reads
SHEAF_CONST COUNT_SLOTS = 1u;         // slots to compact: 1 + kind
SHEAF_CONST COUNT_RAYS = 5u;          // rays of the list at work: 5 + kind
SHEAF_CONST COUNT_CHUNKS = 9u;
SHEAF_CONST COUNT_OVERFLOW = 10u;     // not 0: the band needs more slots than there are
SHEAF_CONST COUNT_PAIRS = 11u;        // pairs that survived a level
SHEAF_CONST COUNT_INCOHERENT = 13u;   // bundles whose rays go one per lane: too wide, or given up
SHEAF_CONST COUNT_SURVIVORS = 15u;    // of a batch of pairs
SHEAF_CONST COUNT_BOUNDS = 16u;       // 6 words: ordered-integer bounds of the batch's origins
SHEAF_CONST COUNT_CELLS = 22u;        // packets or cells of the list
SHEAF_CONST COUNT_WALK_FIRST = 23u;   // cells at work: the first …
SHEAF_CONST COUNT_WALK_CELLS = 24u;   // … and how many; none once their pairs had no room
SHEAF_CONST COUNT_WALK_OVERFLOW = 25u;
SHEAF_CONST COUNT_OPEN = 26u;         // 1: some pair of the level has a node
SHEAF_CONST COUNT_PAIR_HALF = 27u;    // half of the pairs' buffer that holds the last level made
SHEAF_CONST COUNT_PAIR_HALVES = 28u;  // 2 words: pairs in each half
SHEAF_CONST COUNT_WALK_RAY = 30u;     // rays at work: the first …
SHEAF_CONST COUNT_WALK_RAYS = 31u;    // … and how many
SHEAF_CONST COUNT_WORDS = 32u;

// Statistics, 64-bit sums, a block of STAT_FIELDS a kind.
SHEAF_CONST STAT_RAYS = 0u;
SHEAF_CONST STAT_HITS = 1u;
SHEAF_CONST STAT_NODE_OBJECT = 2u;
SHEAF_CONST STAT_RAY_BOX = 3u;
SHEAF_CONST STAT_RAY_TRIANGLE = 4u;
SHEAF_CONST STAT_LEVELS = 5u;         // node-object tests of the levels 0 (rays) … 15
SHEAF_CONST STAT_STOPPED = 21u;       // rays that MOST_BLENDED stopped (of refraction rays; counted in any case)
SHEAF_CONST STAT_FIELDS = 22u;
SHEAF_CONST STAT_SUMS = 4u * STAT_FIELDS;

SHEAF_INTERFACE_END
#endif
