// SPDX-License-Identifier: MIT
// What is scanned for `frustum` and `classify`: see scan_elements.glsl.
#ifndef SHEAF_CELL_ELEMENTS_GLSL
#define SHEAF_CELL_ELEMENTS_GLSL
#include "lib/common.glsl"
#include "interface/hierarchy.h"
#include "interface/push/cells.h"
#include "lib/push.glsl"
#include "lists/rays.glsl"
#include "lib/counters.glsl"
#include "lib/args.glsl"

// There is no room: nothing more is done, the host sees it and repeats the walk with less.
void give_up() {
  counters[COUNT_WALK_OVERFLOW] = 1u;
  counters[COUNT_WALK_CELLS] = counters[COUNT_WALK_RAYS] = 0u;
  counters[COUNT_PAIR_HALVES] = counters[COUNT_PAIR_HALVES + 1u] = 0u;
  set_args(ARGS_PAIR_SCATTER, 0u);
  for (uint args = ARGS_PAIR_RANGES; args < ARGS_COUNT; ++args) set_args(args, 0u);
}

#if defined(SCAN_PACKETS)
// Neighbours with equal keys, BUNDLE at most → packets (S: packet ranges).
BUFFER(ROLE_PACKET_KEYS, readonly, uint, packet_keys);
BUFFER(ROLE_PACKETS, writeonly, uvec2, packets);  // first ray, cell; the end of the list follows the last
PUSH(KindPush);
uint scan_count() { return counters[COUNT_RAYS + push.kind]; }
uint scan_load(uint i) { return i % BUNDLE == 0u || packet_keys[i] != packet_keys[i - 1u] ? 1u : 0u; }
void scan_store(uint i, uint before, uint own) {
  if (own != 0u) packets[before] = uvec2(i, before);
}
void scan_total(uint total) {
  counters[COUNT_CELLS] = total;
  packets[total] = uvec2(scan_count(), total);
}
#elif defined(SCAN_OPEN)
// Children that pairs (cell, node) entered → the pairs of the next level, cell by cell as before, a node's children in
// visiting order; so in the end every cell's leaves stand roughly front to back. What has no room is not written: the
// walk stops there, says so, and the host repeats it with fewer cells.
#include "scene/memory.glsl"
#include "lib/convert.glsl"
BUFFER(ROLE_PAIRS, coherent, uvec2, pairs);
BUFFER(ROLE_SURVIVORS, readonly, uint, entered);
PUSH(OpenScanPush);
uint scan_count() { return counters[COUNT_PAIR_HALVES + push.half_read]; }
uint scan_load(uint i) { return bitCount(entered[i] & (PAIR_KEPT | 255u)); }
void scan_store(uint i, uint before, uint own) {
  uvec2 pair = pairs[push.half_read * push.room + i];
  uint at = (1u - push.half_read) * push.room + before, word = entered[i];
  if ((word & PAIR_KEPT) != 0u) {
    pairs[at] = pair;
    return;
  }
  for (uint mask = word & 255u; mask != 0u; mask &= mask - 1u, ++at) {
    uint slot = lowest_bit(mask) ^ (word >> PAIR_OCTANT);
    uvec2 children = unpack32(node_pairs(pair.y).pair[(NODE_CHILD + slot) / 2u]);
    uint child = (slot & 1u) != 0u ? children.y : children.x;
    pairs[at] = uvec2(pair.x, (child & CHILD_LEAF) == 0u ? child : CHILD_LEAF | (pair.y * WIDE + slot));
  }
}
void scan_total(uint total) {
  uint count = scan_count();
  bool opens = counters[COUNT_OPEN] != 0u || push.always != 0u, fits = total <= push.room;
  bool continues = opens && fits;
  counters[COUNT_OPEN] = 0u;
  set_args(ARGS_PAIR_SCATTER, continues ? groups_of(count, SCAN_BLOCK) : 0u);
  set_args(ARGS_PAIRS, continues ? groups_of(total, GROUP) : 0u);
  set_args(ARGS_PAIR_BLOCKS, continues ? groups_of(total, SCAN_BLOCK) : 0u);
  if (continues) {
    counters[COUNT_PAIR_HALF] = 1u - push.half_read;
    counters[COUNT_PAIR_HALVES + 1u - push.half_read] = total;
    set_args(ARGS_PAIR_RANGES, groups_of(total, GROUP));
  } else if (opens) {
    give_up();
  }
}
#elif defined(SCAN_DIVIDE)
// Rays in the order of their classes → the cells of the next five halvings, only where there are rays. A cell that
// stops stays whole.
BUFFER(ROLE_CELL_CUTS, readonly, uint, cuts);
BUFFER(ROLE_RAY_CELLS, coherent, uint, ray_cells);
BUFFER(ROLE_CELLS, readonly, uvec2, cells);            // above: first ray, cell above that
BUFFER(ROLE_CELL_STOPS, readonly, uint, cell_stops);
BUFFER(ROLE_CELLS_NEXT, writeonly, uvec2, cells_next);
PUSH(DivideScanPush);
uint cell_above(uint ray) { return push.first != 0u ? 0u : ray_cells[ray]; }
uint scan_count() { return counters[COUNT_WALK_RAYS]; }
uint scan_load(uint i) {
  uint ray = counters[COUNT_WALK_RAY] + i, above = cell_above(ray);
  if (cells[above].x == ray) return 1u;
  uint cut = cuts[ray], state = cell_stops[above];
  return state != CELL_STOPS && (cut & (CUT_SMALL - 1u)) <= push.halvings && (cut < CUT_SMALL || state == CELL_CROWDED)
             ? 1u
             : 0u;
}
void scan_store(uint i, uint before, uint own) {
  uint ray = counters[COUNT_WALK_RAY] + i, above = cell_above(ray);
  ray_cells[ray] = before + own - 1u;
  if (own != 0u) cells_next[before] = uvec2(ray, above);
}
void scan_total(uint total) {
  bool fits = total <= push.room;
  set_args(ARGS_WALK_SCATTER, fits ? groups_of(scan_count(), SCAN_BLOCK) : 0u);
  if (!fits) {
    give_up();
    return;
  }
  counters[COUNT_WALK_CELLS] = total;
  cells_next[total] = uvec2(counters[COUNT_WALK_RAY] + scan_count(), 0u);
  set_args(ARGS_WALK_CELLS, total);
  set_args(ARGS_WALK_RUNS, groups_of(total, GROUP));
  set_args(ARGS_CELL_BLOCKS, groups_of(total, SCAN_BLOCK));
}
#elif defined(SCAN_CANDIDATES)
// Candidates that each new cell takes over → where they go.
BUFFER(ROLE_LISTS, readonly, uvec2, lists);            // of the cells above
BUFFER(ROLE_CELLS_NEXT, readonly, uvec2, cells_next);
BUFFER(ROLE_CELL_OFFSETS, writeonly, uint, cell_offsets);
PUSH(CandidatesScanPush);
uint scan_count() { return counters[COUNT_WALK_CELLS]; }
uint scan_load(uint i) {
  uvec2 list = lists[cells_next[i].y];
  return push.root != 0u ? 1u : list.y - list.x;
}
void scan_store(uint i, uint before, uint own) { cell_offsets[i] = before; }
void scan_total(uint total) {
  if (total > push.room) {
    give_up();
    return;
  }
  counters[COUNT_PAIR_HALF] = 1u - push.half_read;
  counters[COUNT_PAIR_HALVES + 1u - push.half_read] = total;
  counters[COUNT_OPEN] = 0u;
  set_args(ARGS_PAIRS, groups_of(total, GROUP));
  set_args(ARGS_PAIR_BLOCKS, groups_of(total, SCAN_BLOCK));
  set_args(ARGS_PAIR_RANGES, groups_of(total, GROUP));
}
#elif defined(SCAN_CLASS_PACKETS)
// Rays of a cell, BUNDLE at most → packets.
BUFFER(ROLE_RAY_CELLS, readonly, uint, ray_cells);
BUFFER(ROLE_CELLS, readonly, uvec2, cells);
BUFFER(ROLE_PACKETS, writeonly, uvec2, packets);
uint scan_count() { return counters[COUNT_WALK_RAYS]; }
uint scan_load(uint i) {
  uint ray = counters[COUNT_WALK_RAY] + i;
  return (ray - cells[ray_cells[ray]].x) % BUNDLE == 0u ? 1u : 0u;
}
void scan_store(uint i, uint before, uint own) {
  uint ray = counters[COUNT_WALK_RAY] + i;
  if (own != 0u) packets[before] = uvec2(ray, ray_cells[ray]);
}
void scan_total(uint total) {
  packets[total] = uvec2(counters[COUNT_WALK_RAY] + scan_count(), 0u);
  counters[COUNT_CELLS] += total;
  counters[COUNT_WALK_CELLS] = total;
  set_args(ARGS_WALK_CELLS, total);
}
#endif
#endif
