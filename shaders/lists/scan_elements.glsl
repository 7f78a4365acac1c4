// SPDX-License-Identifier: MIT
// What is scanned, and what becomes of the result: one of the SCAN_… names, defined by the build's table of variants.
#ifndef SHEAF_SCAN_ELEMENTS_GLSL
#define SHEAF_SCAN_ELEMENTS_GLSL
#include "lib/common.glsl"
#if defined(SCAN_CELLS)
#include "trace/cells/cell_elements.glsl"
#else
#include "interface/push/push.h"
#include "lib/push.glsl"
#include "lists/rays.glsl"
#include "lib/counters.glsl"
#include "lib/args.glsl"
PUSH(KindPush);

#if defined(SCAN_COMPACT)
// Slots that hold a ray → their list, in slot order.
BUFFER(ROLE_STATS, coherent, uint64_t, stats);
uint scan_count() { return counters[COUNT_SLOTS + push.kind]; }
uint scan_load(uint i) { return load_ray_pixel(ray_list.rays, i) != NO_INDEX ? 1u : 0u; }
void scan_store(uint i, uint before, uint own) {
  if (own != 0u) store_slot(ray_list.order, before, i);
}
void scan_total(uint total) {
  counters[COUNT_RAYS + push.kind] = total;
  stats[push.kind * STAT_FIELDS + STAT_RAYS] += uint64_t(total);
  set_list_args(total);
}
#elif defined(SCAN_COMPRESS)
// Neighbours with equal keys → chunks (R 4.2, Compression). The order is kept aside for decompression.
BUFFER(ROLE_KEYS, readonly, uint, keys);
BUFFER(ROLE_CHUNKS, writeonly, uvec3, chunks);  // key, base, size
BUFFER(ROLE_ORDER_KEPT, writeonly, uint, order_kept);
uint scan_count() { return counters[COUNT_RAYS + push.kind]; }
uint scan_load(uint i) { return i == 0u || keys[i] != keys[i - 1u] ? 1u : 0u; }
void scan_store(uint i, uint before, uint own) {
  order_kept[i] = load_slot(ray_list.order, i);
  if (own != 0u) {
    chunks[before].x = keys[i];
    chunks[before].y = i;
  }
}
void scan_total(uint total) {
  counters[COUNT_CHUNKS] = total;
  set_args(ARGS_CHUNKS, groups_of(total, SCAN_BLOCK));
}
#elif defined(SCAN_STARTS)
// Sizes of the sorted chunks → where each starts; its base is set into the skeleton as a head (R 4.2, Decompression).
BUFFER(ROLE_CHUNKS, readonly, uvec3, chunks);
BUFFER(ROLE_SKELETON, writeonly, uint, skeleton);
uint scan_count() { return counters[COUNT_CHUNKS]; }
uint scan_load(uint i) { return chunks[i].z; }
void scan_store(uint i, uint before, uint own) { skeleton[before] = 0x80000000u | chunks[i].y; }
void scan_total(uint total) {}
#elif defined(SCAN_SEGMENTED)
// Inclusive segmented scan of the skeleton: heads hold a chunk's base, the rest 1, so each place gets its ray's old
// place.
BUFFER(ROLE_SKELETON, readonly, uint, skeleton);
BUFFER(ROLE_ORDER_KEPT, readonly, uint, order_kept);
uint scan_count() { return counters[COUNT_RAYS + push.kind]; }
uint scan_load(uint i) { return skeleton[i]; }
#define SCAN_INCLUSIVE
void scan_store(uint i, uint upto, uint own) { store_slot(ray_list.order, i, order_kept[upto & 0x7FFFFFFFu]); }
void scan_total(uint total) {}
#elif defined(SCAN_PAIRS)
// Pairs that survived their test → the list of the next level: no gaps, no reordering (R 4.4).
BUFFER(ROLE_PAIRS, readonly, uvec2, pairs);
BUFFER(ROLE_SURVIVORS, readonly, uint, survivors);
BUFFER(ROLE_PAIRS_NEXT, writeonly, uvec2, pairs_next);
uint scan_count() { return counters[COUNT_PAIRS]; }
uint scan_load(uint i) { return survivors[i]; }
void scan_store(uint i, uint before, uint own) {
  if (own != 0u) pairs_next[before] = pairs[i];
}
void scan_total(uint total) { counters[COUNT_SURVIVORS] = total; }
#else
// Any array of numbers: the primitive itself, for its tests.
BUFFER(ROLE_SCAN_IN, readonly, uint, scan_in);
BUFFER(ROLE_SCAN_OUT, writeonly, uint, scan_out);
uint scan_count() { return counters[0]; }
uint scan_load(uint i) { return scan_in[i]; }
#if defined(SCAN_PLAIN_SEGMENTED)
#define SCAN_INCLUSIVE
#endif
void scan_store(uint i, uint result, uint own) { scan_out[i] = result; }
void scan_total(uint total) { counters[1] = total; }
#endif
#endif
#endif
