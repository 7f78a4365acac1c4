// SPDX-License-Identifier: MIT
// What is scanned for `frustum` and `classify`: see scan_elements.glsl.
#include "rays.glsl"
#include "lists.glsl"
#include "args.glsl"

#if defined(SCAN_PACKETS)
// Neighbours with equal keys, BUNDLE at most → packets (S: packet ranges).
BUFFER(ROLE_PACKET_KEYS, readonly, uint, packet_keys);
BUFFER(ROLE_PACKETS, writeonly, uvec2, packets);  // first ray, cell; the end of the list follows the last
layout(push_constant) uniform Push { uint kind; } push;
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
// Children that pairs (cell, node) entered → the pairs of the next level, cell by cell as before, a node's children in visiting
// order; so in the end every cell's leaves stand roughly front to back. What has no room is not written: the walk stops there,
// says so, and the host repeats it with fewer cells.
#include "memory.glsl"
BUFFER(ROLE_PAIRS, coherent, uvec2, pairs);
BUFFER(ROLE_SURVIVORS, readonly, uint, entered);
layout(push_constant) uniform Push {
  uint half_read;
  uint room;
} push;
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
    uint slot = uint(findLSB(mask)) ^ (word >> PAIR_OCTANT);
    uvec2 children = unpack32(node_pairs(pair.y).pair[(NODE_CHILD + slot) / 2u]);
    uint child = (slot & 1u) != 0u ? children.y : children.x;
    pairs[at] = uvec2(pair.x, (child & CHILD_LEAF) == 0u ? child : CHILD_LEAF | (pair.y * WIDE + slot));
  }
}
void scan_total(uint total) {
  uint count = scan_count();
  bool opens = counters[COUNT_OPEN] != 0u, fits = total <= push.room;
  bool goes_on = opens && fits;
  counters[COUNT_OPEN] = 0u;
  set_args(ARGS_PAIR_SCATTER, goes_on ? groups_of(count, SCAN_BLOCK) : 0u);
  set_args(ARGS_PAIRS, goes_on ? groups_of(total, GROUP) : 0u);
  set_args(ARGS_PAIR_BLOCKS, goes_on ? groups_of(total, SCAN_BLOCK) : 0u);
  if (goes_on) {
    counters[COUNT_PAIR_HALF] = 1u - push.half_read;
    counters[COUNT_PAIR_HALVES + 1u - push.half_read] = total;
    set_args(ARGS_PAIR_RANGES, groups_of(total, GROUP));
  } else if (opens) {
    counters[COUNT_WALK_OVERFLOW] = 1u;
    counters[COUNT_WALK_CELLS] = 0u;
    set_args(ARGS_PAIR_RANGES, 0u);
    set_args(ARGS_WALK_CELLS, 0u);
  }
}
#endif
