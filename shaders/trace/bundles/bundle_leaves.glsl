// SPDX-License-Identifier: MIT
// The leaves of a node that a bundle enters, tested together: which vectors enter each, then the vectors, one after the
// other, each with all the leaves it enters, since to take up a vector's rays costs as much as to test a leaf.
#ifndef SHEAF_BUNDLE_LEAVES_GLSL
#define SHEAF_BUNDLE_LEAVES_GLSL
#include "scene/load_uniform.glsl"
#include "trace/bundles/bundle_rays.glsl"

// Leaves that few rays of a vector enter wait here, and each lane tests its own: were they tested for the vector at
// once, most lanes would look on. Where triangles are as small as the distance between rays, that is one lane in eight
// at work.
//
// A vector's test loads a triangle once, a lane's own gathers it and what belongs to its ray: about three lanes' worth.
bool worth_waiting(uint entering) { return 4u * entering <= LANES; }

void hold_leaf(uint v, uint leaf) {
  bundle.held_vector[bundle.held] = v;
  bundle.held_leaf[bundle.held] = leaf;
  ++bundle.held;
}

// The last leaf of each lane. A lane that holds none has a vector that does not exist.
void test_held() {
  bool has = bundle.held > 0u;
  bundle.held -= has ? 1u : 0u;
  uint leaf = has ? bundle.held_leaf[bundle.held] : 0u;
  Work w = load_work(has ? bundle.held_vector[bundle.held] : VECTORS);
  uint triangle = leaf_first(leaf), last = has ? triangle + leaf_count(leaf) : triangle;
  while (any_lane(triangle < last)) {
    bool is_active = triangle < last;
    test_corners(load_triangle(is_active ? triangle : 0u), triangle, is_active, w);
    ++triangle;
  }
  put_found(w);
}

void test_all_held() {
  if (bundle.most_held == 0u) return;
  while (any_lane(bundle.held > 0u)) test_held();
  [[dont_unroll]] for (uint v = 0u; v < bundle.vectors; ++v) {
    float t;
    PICK(t, bundle.nearest, v);
    bound_vector(v, t);
  }
  bundle.most_held = 0u;
}

#define OF_LEAF(field, at)                                                        \
  (LANES < 8u && (at) >= 4u ? subgroupShuffle(bundle.upper_leaf.field, (at) & 3u) \
                            : OF_LANE(bundle.lower_leaf.field, (at)))

// Which vectors the leaves entered are for.
void hand_out_leaves(uint entered, uint turn) {
  bundle.leaves = entered;
  bundle.leaf_turn = turn;
  bundle.todo = (1u << bundle.vectors) - 1u;
  if (VECTORS > LANES) return;
  bundle.own_leaves = 0u;
  for (uint rest = entered; rest != 0u; rest &= rest - 1u) {
    uint k = lowest_bit(rest), at = k ^ turn;
    if (beam_enters(bundle.vector_beam, OF_LEAF(lo, at), OF_LEAF(hi, at))) bundle.own_leaves |= 1u << k;
  }
  bundle.todo = lanes_where(bundle.own_leaves != 0u, VECTORS);
}

// The first vector that has leaves to test, while what must wait has room.
void test_vector() {
  uint v = lowest_bit(bundle.todo), rest = bundle.leaves_left;
  if (rest == 0u) rest = VECTORS > LANES ? bundle.leaves : OF_LANE(bundle.own_leaves, v);
  Work w = load_work(v);
  bool room = true, tested = false;
  while (rest != 0u && room) {
    uint at = lowest_bit(rest) ^ bundle.leaf_turn;
    rest &= rest - 1u;
    ++bundle.effort;
    vec2 range = slab(w.shear, OF_LEAF(lo, at), OF_LEAF(hi, at));
    bool enters = range.x <= range.y && range.y >= w.tmin && range.x <= w.best.t;
    if (v * LANES + bundle.lane < bundle.ray_count) ++bundle.box_tests;
    uint entering = lanes_that(enters);
    if (entering == 0u) continue;
    uint leaf = OF_LEAF(word, at);
    if (worth_waiting(entering)) {
      if (enters) hold_leaf(v, leaf);
      ++bundle.most_held;
    } else {
      tested = true;
      bundle.most_queued += leaf_count(leaf);
      for (uint triangle = leaf_first(leaf), last = triangle + leaf_count(leaf); triangle < last; ++triangle)
        test_corners(load_triangle_subgroup(triangle), triangle, enters, w);
    }
    room = waiting_has_room();
  }
  if (tested) {
    put_found(w);
    bound_vector(v, w.best.t);
  }
  bundle.leaves_left = rest;
  if (rest == 0u) bundle.todo &= bundle.todo - 1u;
}

void settle_waiting() {
  test_all_held();
  if (asks_materials()) settle_queue();
}
#endif
