// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// One level of the breadth-first walk (S, R 3.4): of every pair's node, the children that the pair's cell may enter.
// Pairs with a leaf stay as they are, or, where cells have become smaller since (`classify`), are tested once more.
// What is entered is marked, a bit a child; a scan makes the next level's pairs of it.
#define COMPUTE
#include "lib/common.glsl"
#include "interface/push/cells.h"
#include "lib/push.glsl"
#extension GL_KHR_shader_subgroup_vote : require
#include "lists/rays.glsl"
#include "lib/counters.glsl"
#include "lib/counting.glsl"
#include "scene/node.glsl"
#include "scene/node_boxes.glsl"
#include "scene/triangle.glsl"
#include "trace/cells/frustum_memory.glsl"
BUFFER(ROLE_PAIRS, readonly, uvec2, pairs);        // cell; node, or CHILD_LEAF and node · 8 + slot
BUFFER(ROLE_SURVIVORS, writeonly, uint, entered);
BUFFER(ROLE_PAIR_LEVELS, coherent, uint, pair_levels);
PUSH(PairsOpenPush);

// Axes of the boxes in the frustum's order: once a node is cheaper than once a child.
Boxes permute_boxes(Boxes b, uint axis) {
  Boxes p;
  p.grid = Grid(permute(b.grid.origin, axis), permute(b.grid.step, axis), b.grid.present);
  p.lx = axis == 0u ? b.ly : axis == 1u ? b.lz : b.lx;
  p.ly = axis == 0u ? b.lz : axis == 1u ? b.lx : b.ly;
  p.lz = axis == 0u ? b.lx : axis == 1u ? b.ly : b.lz;
  p.hx = axis == 0u ? b.hy : axis == 1u ? b.hz : b.hx;
  p.hy = axis == 0u ? b.hz : axis == 1u ? b.hx : b.hy;
  p.hz = axis == 0u ? b.hx : axis == 1u ? b.hy : b.hz;
  return p;
}

uint entered_children(Frustum f, uint node) {
  Boxes boxes = permute_boxes(load_boxes(node), f.axis);
  uint mask = 0u;
  for (uint c = 0u; c < WIDE; ++c) {
    vec3 lo, hi;
    child_box(boxes, c, lo, hi);
    mask |= frustum_enters(f, lo, hi) ? 1u << c : 0u;
  }
  return mask & boxes.grid.present;
}

void main() {
  uint i = global_index();
  bool is_active = i < counters[COUNT_PAIR_HALVES + push.half_read];
  uvec2 pair = is_active ? pairs[push.half_read * push.room + i] : uvec2(0u, CHILD_LEAF);
  uint mask = PAIR_KEPT, tests = 0u;
  if (is_node(pair.y)) {
    Frustum f = load_frustum(push.frustums, pair.x);
    mask = in_visiting_order(entered_children(f, pair.y), f.octant) | (f.octant << PAIR_OCTANT);
    tests = bitCount(unpack_grid(uvec2(0), unpack32(node_pairs(pair.y).pair[1])).present);
  } else if (is_active && push.leaves != 0u) {
    uint place = pair.y & ~CHILD_LEAF;
    Frustum f = load_frustum(push.frustums, pair.x);
    if (!f.settled) {
      mask = (entered_children(f, place / WIDE) & (1u << (place % WIDE))) != 0u ? PAIR_KEPT : 0u;
      tests = 1u;
    }
  }
  if (is_active) entered[i] = mask;
  if (is_node(pair.y)) counters[COUNT_OPEN] = 1u;
  uint sum = subgroupAdd(tests);
  if (subgroupElect() && sum != 0u) atomicAdd(pair_levels[push.level], sum);
  count_tests(push.kind, STAT_NODE_OBJECT, tests);
  count_tests(push.kind, STAT_LEVELS + push.ray_level, tests);
}
