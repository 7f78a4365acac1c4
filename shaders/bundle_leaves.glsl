// SPDX-License-Identifier: MIT
// Leaves that few rays of a vector enter wait here, and each lane tests its own: were they tested for the vector at once, most lanes
// would look on. Where triangles are as small as the distance between rays, that is one lane in eight at work.
uint h_vector[HELD_LEAVES], h_leaf[HELD_LEAVES];

uint lanes_that(bool b) { return LANES > 8u ? subgroupBallotBitCount(subgroupBallot(b)) : bitCount(lanes_where(b)); }

// A vector's test loads a triangle once, a lane's own gathers it and what belongs to its ray: about three lanes' worth.
bool worth_waiting(uint entering) { return 4u * entering <= LANES; }

void hold_leaf(uint v, uint leaf) {
  h_vector[held] = v;
  h_leaf[held] = leaf;
  ++held;
}

// The last leaf of each lane. A lane that holds none has a vector that does not exist.
void test_held() {
  bool has = held > 0u;
  held -= has ? 1u : 0u;
  uint leaf = has ? h_leaf[held] : 0u;
  Work w = load_work(has ? h_vector[held] : VECTORS);
  uint triangle = leaf_first(leaf), last = has ? triangle + leaf_count(leaf) : triangle;
  while (any_lane(triangle < last)) {
    bool there = triangle < last;
    test_corners(load_triangle(there ? triangle : 0u), triangle, there, w);
    ++triangle;
  }
  put_found(w);
}

void test_all_held() {
  if (!any_lane(held > 0u)) return;
  while (any_lane(held > 0u)) test_held();
  [[dont_unroll]] for (uint v = 0u; v < vectors; ++v) {
    float t;
    PICK(t, r_t, v);
    bound_vector(v, t);
  }
}

void settle_waiting() {
  test_all_held();
  if (asks_materials()) settle_queue();
}
