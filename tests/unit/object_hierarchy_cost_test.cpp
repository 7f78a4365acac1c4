// SPDX-License-Identifier: MIT
// How good a tree is, beside whether it is one: neighbours stay together, and its cost is near that of a full sweep.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <numeric>
#include <span>
#include <string>

#include "hierarchy/object_hierarchy.hpp"
#include "hierarchy_sets.hpp"

namespace sheaf {
namespace {

using test::Boxes;
using test::sets;

TEST(ObjectHierarchyCost, OrderKeepsNeighboursTogether) {
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

TEST(ObjectHierarchyCost, CostIsNearThatOfAFullSweep) {
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
