// SPDX-License-Identifier: MIT
// What walks of the object hierarchy share, one ray per lane or a bundle per subgroup: depth first, a stack entry per
// level.
#ifndef SHEAF_VISIT_GLSL
#define SHEAF_VISIT_GLSL
#include "trace/common/candidate.glsl"
#include "scene/memory.glsl"
#include "interface/hierarchy.h"
#include "scene/node.glsl"
#include "lib/convert.glsl"

struct Visit {
  uint group;   // node · 256 + mask of its children still to visit, in visiting order
  uint depth;   // of the stack of groups
  uint octant;  // of the direction
};

uint stack[STACK_SIZE];

// The children of a node that were entered, a bit each, come next; what is left of the group at work waits.
void visit_children(inout Visit v, uint node, uint entered) {
  if (entered == 0u) return;
  if ((v.group & 255u) != 0u) {
    stack[v.depth] = v.group;
    ++v.depth;
  }
  v.group = (node << 8) | in_visiting_order(entered, v.octant);
}

// The next child: a node or a leaf, and where it hangs (node · 8 + slot); CHILD_EMPTY at the end.
uint next_child(inout Visit v, out uint place) {
  place = 0u;
  if ((v.group & 255u) == 0u) {
    if (v.depth == 0u) return CHILD_EMPTY;
    --v.depth;
    v.group = stack[v.depth];
  }
  uint slot = lowest_bit(v.group & 255u) ^ v.octant, node = v.group >> 8;
  v.group &= v.group - 1u;
  place = node * WIDE + slot;
  uvec2 pair = unpack32(node_pairs(node).pair[(NODE_CHILD + slot) / 2u]);
  return (slot & 1u) != 0u ? pair.y : pair.x;
}
#endif
