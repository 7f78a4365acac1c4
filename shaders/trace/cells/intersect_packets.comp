// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// Local intersection tests (S, R 3.4): one subgroup takes a packet's rays through the leaves listed for its cell,
// roughly front to back. Lanes are leaves first: each is tested against what the packet's rays have left to find, so
// that what lies behind all their hits costs no more than that.
//
// Exact: a leaf is left out by the slabs of beam.glsl alone.
#define COMPUTE
#include "lib/common.glsl"
#include "interface/push/cells.h"
#include "lib/push.glsl"
#include "lists/rays.glsl"
#include "scene/scene.glsl"
#include "trace/common/candidate.glsl"
#include "trace/common/results.glsl"
#include "lib/counters.glsl"
#include "lib/counting.glsl"
#include "trace/common/visit.glsl"
#include "trace/bundles/beam.glsl"
BUFFER(ROLE_PACKETS, readonly, uvec2, packets);
BUFFER(ROLE_LISTS, readonly, uvec2, lists);
BUFFER(ROLE_PAIRS, readonly, uvec2, pairs);
BUFFER(ROLE_PAIR_LEVELS, coherent, uint, pair_levels);
PUSH(IntersectPacketsPush);
#include "trace/bundles/bundle_leaves.glsl"

const uint LEAVES = LANES < 32u ? LANES : 32u;  // looked at together

void place_box(uint place, out vec3 lo, out vec3 hi) {
  NodePairs words = node_pairs(place / WIDE);
  uint c = place % WIDE;
  Grid grid = unpack_grid(unpack32(words.pair[0]), unpack32(words.pair[1]));
  child_box(Boxes(grid, unpack32(words.pair[2]), unpack32(words.pair[3]), unpack32(words.pair[4]),
                  unpack32(words.pair[5]), unpack32(words.pair[6]), unpack32(words.pair[7])),
            c, lo, hi);
}

uint place_child(uint place) {
  uvec2 pair = unpack32(node_pairs(place / WIDE).pair[(NODE_CHILD + place % WIDE) / 2u]);
  return (place & 1u) != 0u ? pair.y : pair.x;
}

void test_list(Beam beam, uvec2 list) {
  for (uint base = list.x; base < list.y && beam.farthest > -INFINITY; base += LEAVES) {
    uint mine = base + min(bundle.lane, LEAVES - 1u);
    uint place = pairs[min(mine, list.y - 1u)].y & ~CHILD_LEAF;
    vec3 lo, hi;
    place_box(place, lo, hi);
    bundle.lower_leaf = Leaf(lo, hi, place_child(place));
    bool is_active = bundle.lane < LEAVES && mine < list.y;
    if (is_active) ++bundle.node_tests;
    uint entered = lanes_where(is_active && beam_enters(beam, lo, hi));
    if (entered == 0u) continue;
    hand_out_leaves(entered, 0u);
    while (bundle.todo != 0u) {
      if (!waiting_has_room()) settle_waiting();
      test_vector();
    }
    beam.farthest = farthest_hit();
  }
  settle_waiting();
}

void main() {
  if (global_group() >= counters[COUNT_WALK_CELLS]) return;
  uint packet = counters[COUNT_WALK_FIRST] + global_group();
  uvec2 own = packets[packet];
  begin_bundle(ray_list, own.x, packets[packet + 1u].x - own.x);
  Beam beam = load_bundle();
  uvec2 list = lists[own.y - counters[COUNT_WALK_FIRST]];
  test_list(beam, list + counters[COUNT_PAIR_HALF] * push.room);
  [[dont_unroll]] for (uint v = 0u; v < bundle.vectors; ++v) store(v);
  uint sum = subgroupAdd(bundle.node_tests);
  if (subgroupElect() && sum != 0u) atomicAdd(pair_levels[push.level], sum);
  count_tests(push.kind, STAT_NODE_OBJECT, bundle.node_tests);
  count_tests(push.kind, STAT_LEVELS + 3u, bundle.node_tests);
  count_tests(push.kind, STAT_RAY_BOX, bundle.box_tests);
  count_tests(push.kind, STAT_RAY_TRIANGLE, bundle.triangle_tests);
}
