// SPDX-License-Identifier: MIT
#include "hierarchy/object_hierarchy.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>

#include "core/error.hpp"
#include "hierarchy/binary_hierarchy.hpp"
#include "hierarchy_sets.hpp"

namespace sheaf {
namespace {

using test::around;
using test::Boxes;
using test::Set;
using test::sets;

bool holds(const Box& outer, const Box& inner) {
  for (int a = 0; a < 3; ++a) {
    if (inner.lo[a] < outer.lo[a] || inner.hi[a] > outer.hi[a]) return false;
  }
  return true;
}

/// Every claim of object_hierarchy.hpp about a tree; returns its number of levels.
std::uint32_t expect_valid(const ObjectHierarchy& tree, const Boxes& boxes, std::uint32_t leaf_size) {
  EXPECT_EQ(tree.order.size(), boxes.size());
  EXPECT_EQ(tree.height.size(), tree.nodes.size());
  std::vector<int> times_ordered(boxes.size()), times_in_leaf(boxes.size());
  for (const std::uint32_t p : tree.order) ++times_ordered.at(p);
  std::vector<std::uint32_t> level(tree.nodes.size(), 0), parents(tree.nodes.size(), 0);
  std::uint32_t levels = 0;
  for (std::uint32_t n = 0; n < tree.nodes.size(); ++n) {  // parents come first, so levels are known in time
    levels = std::max(levels, level[n] + 1);
    bool ended = false;
    std::uint32_t height = 0;
    for (std::uint32_t c = 0; c < wide; ++c) {
      const std::uint32_t child = tree.nodes[n].child[c];
      const Box& bounds = tree.nodes[n].bounds[c];
      if (child == empty_child) {
        ended = true;
        EXPECT_EQ(bounds.lo, glm::vec3(std::numeric_limits<float>::max()));
        EXPECT_EQ(bounds.hi, glm::vec3(-std::numeric_limits<float>::max()));
        continue;
      }
      EXPECT_FALSE(ended) << "an empty child before a used one in node " << n;
      if (is_leaf(child)) {
        EXPECT_LE(leaf_count(child), leaf_size);
        for (std::uint32_t i = 0; i < leaf_count(child); ++i) {
          const std::uint32_t place = leaf_first(child) + i;
          ++times_in_leaf.at(place);
          EXPECT_TRUE(holds(bounds, boxes[tree.order.at(place)]));
        }
      } else {
        EXPECT_GT(child, n);
        ++parents.at(child);
        level.at(child) = level[n] + 1;
        height = std::max(height, tree.height.at(child) + 1);
        for (std::uint32_t g = 0; g < wide; ++g) {
          if (tree.nodes[child].child[g] != empty_child) {
            EXPECT_TRUE(holds(bounds, tree.nodes[child].bounds[g]));
          }
        }
      }
    }
    EXPECT_EQ(tree.height[n], height);
    EXPECT_EQ(parents[n], n == 0 ? 0u : 1u);
  }
  EXPECT_LE(levels, max_wide_levels);
  EXPECT_TRUE(std::all_of(times_ordered.begin(), times_ordered.end(), [](int t) { return t == 1; }));
  EXPECT_TRUE(std::all_of(times_in_leaf.begin(), times_in_leaf.end(), [](int t) { return t == 1; }));
  return levels;
}

class ObjectHierarchyTest : public testing::TestWithParam<Set> {};
INSTANTIATE_TEST_SUITE_P(Sets, ObjectHierarchyTest, testing::ValuesIn(sets()), [](const auto& instance) {
  std::string name = instance.param.name;
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c == ' ' || c == '.'; }, '_');
  return name;
});

TEST_P(ObjectHierarchyTest, IsValidForEverySmallSize) {
  for (std::uint32_t count = 0; count <= 70; ++count) {
    for (const std::uint32_t leaf_size : {1u, 4u, 16u}) {
      SCOPED_TRACE("count " + std::to_string(count) + ", leaf size " + std::to_string(leaf_size));
      const Boxes boxes = GetParam().make(count);
      expect_valid(build_object_hierarchy(boxes, {.leaf_size = leaf_size}), boxes, leaf_size);
    }
  }
}

TEST_P(ObjectHierarchyTest, IsValidAndTheSameForAnyNumberOfThreads) {
  const Boxes boxes = GetParam().make(200'000);
  const ObjectHierarchy one = build_object_hierarchy(boxes, {.threads = 1});
  expect_valid(one, boxes, 4);
  for (const std::uint32_t threads : {2u, 5u}) {
    const ObjectHierarchy other = build_object_hierarchy(boxes, {.threads = threads});
    EXPECT_EQ(one.order, other.order);
    ASSERT_EQ(one.nodes.size(), other.nodes.size());
    for (std::size_t i = 0; i < one.nodes.size(); ++i) {
      ASSERT_EQ(one.nodes[i].child, other.nodes[i].child);
      for (std::size_t c = 0; c < wide; ++c) {
        ASSERT_EQ(one.nodes[i].bounds[c].lo, other.nodes[i].bounds[c].lo);
        ASSERT_EQ(one.nodes[i].bounds[c].hi, other.nodes[i].bounds[c].hi);
      }
    }
    EXPECT_EQ(one.height, other.height);
  }
}

TEST(ObjectHierarchy, NoBoxGivesOneEmptyNode) {
  const ObjectHierarchy tree = build_object_hierarchy({});
  ASSERT_EQ(tree.nodes.size(), 1u);
  EXPECT_TRUE(std::all_of(tree.nodes[0].child.begin(), tree.nodes[0].child.end(),
                          [](std::uint32_t child) { return child == empty_child; }));
  EXPECT_EQ(tree.height, std::vector<std::uint32_t>{0});
}

TEST(ObjectHierarchy, AMillionEqualBoxesAreBalanced) {
  const Boxes boxes(1'000'000, around(glm::vec3(1), glm::vec3(1)));
  // 250,000 leaves of four: six levels of eight would hold 262,144.
  EXPECT_EQ(expect_valid(build_object_hierarchy(boxes), boxes, 4), 6u);
}

TEST(ObjectHierarchy, DepthStaysBoundedWhereTheHeuristicWouldPeelOneByOne) {
  // Point-like boxes at 2^-i in every direction, many at each place: SAH alone builds a chain.
  Boxes boxes;
  for (int i = 0; i < 200; ++i) {
    for (int j = 0; j < 300; ++j) {
      const float at = std::ldexp(1.0f, 100 - i);
      boxes.push_back(around(glm::vec3(at, j % 2 ? at : -at, at), glm::vec3(at * 1e-3f)));
    }
  }
  for (const std::uint32_t leaf_size : {1u, 4u}) {
    expect_valid(build_object_hierarchy(boxes, {.leaf_size = leaf_size}), boxes, leaf_size);
  }
}

TEST(ObjectHierarchy, TightBinaryBoundIsMet) {
  const Boxes boxes = sets()[7].make(1000);
  // 1000 boxes need exactly ten halvings.
  const BinaryHierarchy tree = build_binary_hierarchy(boxes, {.leaf_size = 1}, 10);
  EXPECT_EQ(tree.nodes[0].height, 10u);
}

TEST(ObjectHierarchy, RefusesBadOptions) {
  const Boxes boxes(3, around(glm::vec3(0), glm::vec3(1)));
  EXPECT_THROW((void)build_object_hierarchy(boxes, {.leaf_size = 0}), Error);
  EXPECT_THROW((void)build_object_hierarchy(boxes, {.leaf_size = 17}), Error);
  EXPECT_EQ(build_object_hierarchy(boxes, {.threads = 0}).order.size(), 3u);
}

}  // namespace
}  // namespace sheaf
