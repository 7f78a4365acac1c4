// SPDX-License-Identifier: MIT
// The walk of visit.glsl where all lanes of a subgroup go the same way: the stack is spread over them, an entry per
// lane, and so are the children of the node at work. To pick one is an exchange, where a load or a store goes lane by
// lane on a CPU device.
#ifndef SHEAF_VISIT_SUBGROUP_GLSL
#define SHEAF_VISIT_SUBGROUP_GLSL
#include "lib/convert.glsl"
#include "lib/lanes.glsl"
#include "scene/memory.glsl"
#include "scene/node.glsl"
#include "trace/common/visit.glsl"
const uint STACK_ROWS = (STACK_SIZE + LANES - 1u) / LANES;
uint stack_row[STACK_ROWS];
uvec2 children;  // second: the upper four, where there are but four lanes
uint children_of = CHILD_EMPTY;

void hold_children(uint node) {
  if (children_of == node) return;
  children_of = node;
  children.x = node_word(node, NODE_CHILD + (gl_SubgroupInvocationID & 7u));
  if (LANES < 8u) children.y = node_word(node, NODE_CHILD + 4u + (gl_SubgroupInvocationID & 3u));
}

// Of a slot of each lane's own.
uint own_child(uint slot) {
  return LANES < 8u && slot >= 4u ? subgroupShuffle(children.y, slot & 3u) : subgroupShuffle(children.x, slot);
}

uint child_subgroup(uint slot) { return IN_TURN ? OF_LANE(children.x, slot) : own_child(slot); }

// Which of the children held are leaves, a bit each; of slots that are empty it means nothing.
uint leaf_children() {
  if (LANES < 8u) return lanes_where(!is_node(children.x)) & 15u | (lanes_where(!is_node(children.y)) & 15u) << 4;
  return lanes_where(!is_node(children.x), WIDE) & 255u;
}

// The node's children that were entered, a bit each, come next.
void visit_children_subgroup(inout Visit v, uint node, uint entered) {
  if (entered == 0u) return;
  if ((v.group & 255u) != 0u) {
    [[unroll]] for (uint r = 0u; r < STACK_ROWS; ++r)
      stack_row[r] = v.depth == r * LANES + gl_SubgroupInvocationID ? v.group : stack_row[r];
    ++v.depth;
  }
  v.group = (node << 8) | in_visiting_order(entered, v.octant);
}

uint stacked_group(uint depth) {
  uint row = stack_row[0];
  [[unroll]] for (uint r = 1u; r < STACK_ROWS; ++r) row = depth >= r * LANES ? stack_row[r] : row;
  return OF_LANE(row, depth % LANES);
}

// As next_child().
uint next_child_subgroup(inout Visit v) {
  if ((v.group & 255u) == 0u) {
    if (v.depth == 0u) return CHILD_EMPTY;
    --v.depth;
    v.group = stacked_group(v.depth);
  }
  hold_children(v.group >> 8);
  uint slot = lowest_bit(v.group & 255u) ^ v.octant;
  v.group &= v.group - 1u;
  return child_subgroup(slot);
}

// For lanes that go on alone.
void unspread_stack(Visit v) {
  for (uint d = 0u; d < v.depth; ++d) stack[d] = stacked_group(d);
}
#endif
