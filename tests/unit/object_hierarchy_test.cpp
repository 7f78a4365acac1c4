// SPDX-License-Identifier: MIT
#include "hierarchy/object_hierarchy.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numeric>
#include <random>
#include <string>

#include "core/error.hpp"
#include "hierarchy/binary_hierarchy.hpp"

namespace sheaf {
namespace {

using Boxes = std::vector<Box>;

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

Box around(glm::vec3 middle, glm::vec3 half) { return {middle - half, middle + half}; }

using Source = std::function<Boxes(std::uint32_t)>;

struct Set {
  std::string name;
  Source make;
};

glm::vec3 random_point(std::mt19937& random) {
  std::uniform_real_distribution<float> unit(-1, 1);
  const float x = unit(random), y = unit(random), z = unit(random);
  return {x, y, z};
}

Boxes generate(std::uint32_t count, const std::function<Box(std::mt19937&, std::uint32_t)>& one) {
  std::mt19937 random(count * 7919 + 1);
  Boxes boxes;
  for (std::uint32_t i = 0; i < count; ++i) boxes.push_back(one(random, i));
  return boxes;
}

std::vector<Set> sets() {
  const auto set = [](const char* name, std::function<Box(std::mt19937&, std::uint32_t)> one) {
    return Set{name, [one](std::uint32_t count) { return generate(count, one); }};
  };
  constexpr float inf = std::numeric_limits<float>::infinity(), most = std::numeric_limits<float>::max();
  return {
      set("random", [](auto& r, auto) { return around(10.0f * random_point(r), glm::vec3(0.1f)); }),
      set("clustered",
          [](auto& r, auto i) {
            return around(glm::vec3(static_cast<float>(i % 5) * 100) + 1e-3f * random_point(r), glm::vec3(1e-4f));
          }),
      set("identical", [](auto&, auto) { return around(glm::vec3(1, 2, 3), glm::vec3(0.5f)); }),
      set("points", [](auto& r, auto) { return around(random_point(r), glm::vec3(0)); }),
      set("collinear", [](auto&, auto i) { return around(glm::vec3(i, 0, 0), glm::vec3(0)); }),
      set("nested", [](auto&, auto i) { return around(glm::vec3(0), glm::vec3(static_cast<float>(i + 1))); }),
      set("sizes 1 to 1e6",
          [](auto& r, auto) {
            const float size = std::pow(10.0f, std::uniform_real_distribution<float>(-3, 3)(r));
            return around(100.0f * random_point(r), glm::vec3(size));
          }),
      // Each box is half as far from the corner as the one before: the heuristic would cut off one at a time.
      set("halving distances",
          [](auto&, auto i) {
            const float at = std::ldexp(1.0f, -static_cast<int>(i % 120));
            return around(glm::vec3(at), glm::vec3(at * 0.1f));
          }),
      set("infinite",
          [=](auto& r, auto i) -> Box {
            if (i % 7 == 3) return {glm::vec3(-inf), glm::vec3(inf)};
            if (i % 7 == 5) return {glm::vec3(-most), glm::vec3(inf, 0, most)};
            return around(random_point(r), glm::vec3(0.1f));
          }),
      set("denormal", [](auto& r, auto) { return around(1e-41f * random_point(r), glm::vec3(1e-43f)); }),
  };
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

TEST(ObjectHierarchy, OrderKeepsNeighboursTogether) {
  const Boxes boxes = sets()[0].make(50'000);
  const ObjectHierarchy tree = build_object_hierarchy(boxes);
  double ordered = 0, shuffled = 0;
  for (std::size_t i = 1; i < boxes.size(); ++i) {
    ordered += glm::distance(boxes[tree.order[i]].lo, boxes[tree.order[i - 1]].lo);
    shuffled += glm::distance(boxes[i].lo, boxes[i - 1].lo);
  }
  EXPECT_LT(ordered, shuffled / 10);
}

// The cost model, and a reference that tries every plane between sorted middles along every axis.

double half_area(const Box& b) {
  const glm::dvec3 d = glm::dvec3(b.hi) - glm::dvec3(b.lo);
  return d.x * d.y + d.y * d.z + d.z * d.x;
}

Box unite(const Box& a, const Box& b) { return {glm::min(a.lo, b.lo), glm::max(a.hi, b.hi)}; }

Box unite(const Boxes& boxes, std::span<const std::uint32_t> members) {
  Box all;
  for (const std::uint32_t m : members) all = unite(all, boxes[m]);
  return all;
}

double cost(const ObjectHierarchy& tree) {
  double sum = 0;
  Box root;
  for (const Box& b : tree.nodes[0].bounds) root = unite(root, b);
  sum += half_area(root);
  for (const WideNode& node : tree.nodes) {
    for (std::uint32_t c = 0; c < wide; ++c) {
      if (node.child[c] == empty_child) continue;
      sum += half_area(node.bounds[c]) * (is_leaf(node.child[c]) ? leaf_count(node.child[c]) : 1);
    }
  }
  return sum / half_area(root);
}

struct SweepNode {
  Box bounds;
  std::uint32_t count;
  std::unique_ptr<SweepNode> left, right;
};

std::unique_ptr<SweepNode> sweep(const Boxes& boxes, std::span<std::uint32_t> members, std::uint32_t leaf_size) {
  auto node = std::make_unique<SweepNode>();
  node->bounds = unite(boxes, members);
  node->count = static_cast<std::uint32_t>(members.size());
  double best = std::numeric_limits<double>::infinity();
  std::size_t best_at = 0;
  int best_axis = 0;
  const auto sort_by = [&](int axis) {
    std::sort(members.begin(), members.end(), [&](std::uint32_t a, std::uint32_t b) {
      return boxes[a].lo[axis] + boxes[a].hi[axis] < boxes[b].lo[axis] + boxes[b].hi[axis];
    });
  };
  for (int axis = 0; axis < 3; ++axis) {
    sort_by(axis);
    std::vector<double> right_cost(members.size());
    Box right, left;
    for (std::size_t i = members.size(); i-- > 1;) {
      right = unite(right, boxes[members[i]]);
      right_cost[i] = half_area(right) * static_cast<double>(members.size() - i);
    }
    for (std::size_t i = 1; i < members.size(); ++i) {
      left = unite(left, boxes[members[i - 1]]);
      const double here = half_area(left) * static_cast<double>(i) + right_cost[i];
      if (here < best) {
        best = here;
        best_at = i;
        best_axis = axis;
      }
    }
  }
  const double area = half_area(node->bounds);
  if (members.size() == 1 || (members.size() <= leaf_size && area + best >= area * node->count)) return node;
  sort_by(best_axis);
  node->left = sweep(boxes, members.first(best_at), leaf_size);
  node->right = sweep(boxes, members.subspan(best_at), leaf_size);
  return node;
}

double folded_cost(const SweepNode& node) {
  std::vector<const SweepNode*> children{&node};
  while (children.size() < wide) {
    auto largest = children.end();
    for (auto c = children.begin(); c != children.end(); ++c) {
      if ((*c)->left && (largest == children.end() || half_area((*c)->bounds) > half_area((*largest)->bounds))) {
        largest = c;
      }
    }
    if (largest == children.end()) break;
    const SweepNode* opened = *largest;
    *largest = opened->left.get();
    children.push_back(opened->right.get());
  }
  double sum = half_area(node.bounds);
  for (const SweepNode* child : children) {
    sum += child->left ? folded_cost(*child) : half_area(child->bounds) * child->count;
  }
  return sum;
}

TEST(ObjectHierarchy, CostIsNearThatOfAFullSweep) {
  for (const std::size_t set : {0u, 1u, 6u}) {
    const Boxes boxes = sets()[set].make(20'000);
    std::vector<std::uint32_t> members(boxes.size());
    std::iota(members.begin(), members.end(), 0u);
    const auto reference = sweep(boxes, members, 4);
    const double best = folded_cost(*reference) / half_area(reference->bounds);
    const double ours = cost(build_object_hierarchy(boxes));
    EXPECT_LT(ours, best * 1.2) << sets()[set].name;
    RecordProperty("cost_ratio_" + std::to_string(set), std::to_string(ours / best));
  }
}

}  // namespace
}  // namespace sheaf
