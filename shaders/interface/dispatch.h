// SPDX-License-Identifier: MIT
// Records of indirect dispatches, and the sizes of workgroups.
#ifndef SHEAF_INTERFACE_DISPATCH_H
#define SHEAF_INTERFACE_DISPATCH_H
#include "interface/types.h"
SHEAF_INTERFACE_BEGIN

// Indirect dispatch arguments: three words each.
SHEAF_CONST ARGS_RAYS = 0u;       // one invocation a ray of the list
SHEAF_CONST ARGS_BLOCKS = 1u;     // one workgroup a scan block of the list
SHEAF_CONST ARGS_BUNDLES = 2u;    // one workgroup a bundle of the list
SHEAF_CONST ARGS_CHUNKS = 3u;     // one workgroup a sort block of the chunks
SHEAF_CONST ARGS_PARENTS = 4u;    // one invocation a parent
SHEAF_CONST ARGS_SLOTS = 5u;      // one workgroup a scan block of the slots
SHEAF_CONST ARGS_PAIR_SCATTER = 6u;  // like ARGS_PAIR_BLOCKS, or nothing where the next level has no room
SHEAF_CONST ARGS_INCOHERENT = 7u;  // one invocation per ray of an incoherent bundle
SHEAF_CONST ARGS_ONE = 8u;        // a single workgroup, or nothing when the list is empty
SHEAF_CONST ARGS_PARENTS_REFRACTION = 9u;
SHEAF_CONST ARGS_SLOTS_SHADOW = 10u;
SHEAF_CONST ARGS_PAIR_RANGES = 11u;    // one invocation a pair of the last level made
SHEAF_CONST ARGS_WALK_RUNS = 12u;      // one invocation a cell of the walk
SHEAF_CONST ARGS_WALK_CELLS = 13u;     // one workgroup a cell of the walk
SHEAF_CONST ARGS_PAIRS = 14u;          // one invocation a pair of the level at work
SHEAF_CONST ARGS_PAIR_BLOCKS = 15u;    // one workgroup a scan block of them
SHEAF_CONST ARGS_WALK_BLOCKS = 16u;    // one workgroup a scan block of the walk's rays
SHEAF_CONST ARGS_WALK_SCATTER = 17u;   // the same, or nothing where the cells have no room
SHEAF_CONST ARGS_CELL_BLOCKS = 18u;    // one workgroup a scan block of the walk's cells
SHEAF_CONST ARGS_COUNT = 19u;

SHEAF_CONST GROUP = 64u;          // invocations of a plain workgroup
SHEAF_CONST SCAN_GROUP = 32u;     // invocations of a scan workgroup …
SHEAF_CONST SCAN_RUN = 32u;       // … each with a run of elements: a serial loop is the cheapest scan on a CPU device
SHEAF_CONST SCAN_BLOCK = SCAN_GROUP * SCAN_RUN;
SHEAF_CONST RADIX_BITS = 4u;
SHEAF_CONST RADIX = 1u << RADIX_BITS;
SHEAF_CONST BUNDLE = 64u;         // rays of a packet, or of a bundle at least: level 3 of the arity-4 hierarchy
SHEAF_CONST ARITY = 4u;
SHEAF_CONST PART_TRIANGLES = 4u;  // of an instance, that one sphere stands for
SHEAF_CONST MAX_LEVELS = 16u;

SHEAF_INTERFACE_END
#endif
