// SPDX-License-Identifier: MIT
#include "hierarchy/slot_order.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace sheaf {
namespace {

WideNode node_of(const std::vector<Box>& boxes) {
  WideNode node;
  node.child.fill(empty_child);
  for (std::uint32_t c = 0; c < boxes.size(); ++c) {
    node.child[c] = leaf_child(c, 1);
    node.bounds[c] = boxes[c];
  }
  return node;
}

Box around(const glm::vec3& middle) { return {middle - 0.25F, middle + 0.25F}; }

TEST(SlotOrder, CornersGoToTheirOctants) {
  std::vector<Box> boxes;
  for (std::uint32_t corner = 8; corner-- > 0;)
    boxes.push_back(around({corner & 1U ? 1 : -1, corner & 2U ? 1 : -1, corner & 4U ? 1 : -1}));
  WideNode node = node_of(boxes);
  order_slots(node);
  for (std::uint32_t slot = 0; slot < wide; ++slot) EXPECT_EQ(leaf_first(node.child[slot]), 7 - slot);
}

TEST(SlotOrder, NothingIsLostOrParted) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> place(-100, 100);
  for (std::uint32_t count = 0; count <= wide; ++count)
    for (int run = 0; run < 50; ++run) {
      std::vector<Box> boxes;
      for (std::uint32_t c = 0; c < count; ++c)
        boxes.push_back(run == 0 ? around(glm::vec3(0)) : around({place(random), place(random), place(random)}));
      WideNode node = node_of(boxes);
      order_slots(node);
      std::vector<std::uint32_t> seen;
      for (std::uint32_t slot = 0; slot < wide; ++slot) {
        if (node.child[slot] == empty_child) continue;
        const std::uint32_t c = leaf_first(node.child[slot]);
        EXPECT_EQ(node.bounds[slot].lo, boxes[c].lo);
        EXPECT_EQ(node.bounds[slot].hi, boxes[c].hi);
        seen.push_back(c);
      }
      std::sort(seen.begin(), seen.end());
      ASSERT_EQ(seen.size(), count);
      for (std::uint32_t c = 0; c < count; ++c) EXPECT_EQ(seen[c], c);
    }
}

TEST(SlotOrder, HugeBoxesStayFinite) {
  const float huge = 3e38F;
  WideNode node = node_of({{glm::vec3(-huge), glm::vec3(huge)}, {glm::vec3(huge), glm::vec3(huge)}});
  order_slots(node);
  EXPECT_EQ(node.child[7], leaf_child(1, 1));
}

}  // namespace
}  // namespace sheaf
