// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// Subdivision (R 3.1, 3.2): where in the order of keys cells begin, and at which halving. Neighbours are parted by the
// first halving at which their keys differ. Where the cell that it halves has no more than CLASS_RAYS rays the cut is
// marked: such a cell stays whole, and so do all below it, while its candidates are few. Faces are always parted.
#define COMPUTE
#include "lib/common.glsl"
#include "interface/hierarchy.h"
#include "interface/push/push.h"
#include "lib/push.glsl"
#include "lists/rays.glsl"
#include "lib/counters.glsl"
BUFFER(ROLE_KEYS, readonly, uint, keys);
BUFFER(ROLE_CELL_CUTS, writeonly, uint, cuts);
PUSH(KindPush);

const uint CLASS_RAYS = 64u;  // a power of two
const uint NEVER = CLASS_HALVINGS + 1u;

// Rays in the order from i on (forward), or before i, that share its key without the lowest bits; counted to 2
// CLASS_RAYS − 1.
uint reach(uint i, uint count, uint shared_key, uint bits, bool forward) {
  uint found = 0u;
  for (uint more = CLASS_RAYS; more > 0u; more >>= 1) {
    uint next = found + more;
    bool inside = forward ? next <= count - i : next <= i;
    if (inside && (keys[forward ? i + next - 1u : i - next] >> bits) == shared_key) found = next;
  }
  return found;
}

void main() {
  uint i = global_index(), count = counters[COUNT_RAYS + push.kind];
  if (i >= count) return;
  uint key = keys[i], parted = i == 0u ? 0u : key ^ keys[i - 1u], cut = NEVER;
  if (parted != 0u) {
    uint bits = uint(findMSB(parted)) + 1u, shared_key = key >> bits;
    cut = bits > CLASS_HALVINGS ? 0u : CLASS_HALVINGS + 1u - bits;
    if (cut != 0u && reach(i, count, shared_key, bits, true) + reach(i, count, shared_key, bits, false) <= CLASS_RAYS)
      cut |= CUT_SMALL;
  }
  cuts[i] = cut;
}
