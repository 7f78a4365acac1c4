// SPDX-License-Identifier: MIT
// Second step: the binary tree is folded to eight children a node so that the surfaces of all nodes have the least sum,
// which is how many of them a ray enters (Ylitie, Karras, Laine, HPG 2017, section 3.1: by dynamic programming).
// Children keep the binary tree's order, low side first, so the primitives below any node stay consecutive and
// neighbours in space stay neighbours in `order`.
#include "hierarchy/object_hierarchy.hpp"

#include <algorithm>
#include <limits>
#include <string>

#include "core/error.hpp"
#include "hierarchy/binary_hierarchy.hpp"

namespace sheaf {
namespace {

// Depth bound. A binary subtree of height h folds into ceil(h / 3) wide levels, since three binary levels have at most
// eight nodes. So a binary height of 3 * 16 is enough for 16 wide levels, provided that a node with r levels left (its
// own included) leaves no child of more than 3 (r - 1): such children are opened before surface is looked at. They
// all lie within the top three binary levels, hence never more than eight children. A balanced tree over 2^27
// primitives needs 27 of the 48 levels: the heuristic is free for the rest.
constexpr std::uint32_t binary_levels = 3;

float half_area(const Box& box) {
  const glm::vec3 d = box.hi - box.lo;
  return d.x * d.y + d.y * d.z + d.z * d.x;
}

struct Fold {
  const BinaryNode* tree;
  std::array<std::uint32_t, wide> child{};
  std::uint32_t count = 1;

  void open(std::uint32_t place) {
    const std::uint32_t left = tree[child[place]].left;
    for (std::uint32_t i = count; i > place + 1; --i) child[i] = child[i - 1];
    child[place] = left;
    child[place + 1] = left + 1;
    ++count;
  }

  /// Place of the inner child higher than `above` with the largest surface, or `wide`. Of equal ones the fullest is
  /// taken, which keeps heaps of equal boxes balanced.
  [[nodiscard]] std::uint32_t largest(std::uint32_t above) const {
    std::uint32_t best = wide;
    float best_area = -1;
    for (std::uint32_t i = 0; i < count; ++i) {
      const BinaryNode& node = tree[child[i]];
      if (node.leaf() || node.height <= above) continue;
      const float area = half_area(node.bounds);
      if (best == wide || area > best_area || (area == best_area && node.count > tree[child[best]].count)) {
        best = i;
        best_area = area;
      }
    }
    return best;
  }
};

// Opened again and again: first what is too high, then the child with the largest surface.
Fold fold_within(const BinaryNode* tree, std::uint32_t root, std::uint32_t levels_left) {
  Fold result{tree, {root}};
  const std::uint32_t allowed = binary_levels * (levels_left - 1);
  for (std::uint32_t place; (place = result.largest(allowed)) != wide;) result.open(place);
  while (result.count < wide) {
    const std::uint32_t place = result.largest(0);
    if (place == wide) break;
    result.open(place);
  }
  return result;
}

// A forest over a binary node's primitives has roots that become children of one wide node. For 2 to 8 roots: how many
// the left side gets at the best, three bits each; 0 where no better than with one root less. A forest of one root is
// the node itself.
[[nodiscard]] std::uint32_t left_share(const BinaryNode& node, std::uint32_t roots) {
  return (node.shares >> (3 * (roots - 2))) & 7U;
}

using Costs = std::array<float, wide>;  // of 1 to 8 roots at most: the surfaces of all wide nodes below, roots included

Costs share_out(BinaryNode* tree, std::uint32_t at) {
  BinaryNode& node = tree[at];
  if (node.leaf()) return {};
  const Costs left = share_out(tree, node.left), right = share_out(tree, node.left + 1);
  Costs shared{};
  std::array<std::uint32_t, wide> share{};
  for (std::uint32_t roots = 2; roots <= wide; ++roots) {
    float& best = shared[roots - 1];
    best = std::numeric_limits<float>::infinity();
    for (std::uint32_t k = 1; k < roots; ++k) {
      const float cost = left[k - 1] + right[roots - k - 1];
      if (!(cost < best) && k > 1) continue;
      best = cost;
      share[roots - 1] = k;
    }
  }
  shared[0] = half_area(node.bounds) + shared[wide - 1];
  node.shares = share[wide - 1] << (3 * (wide - 2));  // as a wide node itself it always has eight to give
  for (std::uint32_t roots = 2; roots < wide; ++roots) {
    if (shared[roots - 1] < shared[roots - 2])
      node.shares |= share[roots - 1] << (3 * (roots - 2));
    else
      shared[roots - 1] = shared[roots - 2];
  }
  shared[wide - 1] = std::min(shared[wide - 1], shared[wide - 2]);
  return shared;
}

void collect_roots(const BinaryNode* tree, std::uint32_t at, std::uint32_t roots, Fold& into) {
  const BinaryNode& node = tree[at];
  while (roots > 1 && !node.leaf() && left_share(node, roots) == 0) --roots;
  if (roots == 1 || node.leaf()) {
    into.child[into.count++] = at;
    return;
  }
  const std::uint32_t left = left_share(node, roots);
  collect_roots(tree, node.left, left, into);
  collect_roots(tree, node.left + 1, roots - left, into);
}

Fold fold(const BinaryNode* tree, std::uint32_t root, std::uint32_t levels_left) {
  Fold result{tree};
  result.count = 0;
  collect_roots(tree, root, wide, result);
  const std::uint32_t allowed = binary_levels * (levels_left - 1);
  for (std::uint32_t i = 0; i < result.count; ++i)
    if (tree[result.child[i]].height > allowed) return fold_within(tree, root, levels_left);
  return result;
}

struct Pending {
  std::uint32_t binary, parent, place, levels_left;
};

void collapse(const BinaryNode* tree, ObjectHierarchy& into) {
  std::vector<Pending> stack{{0, empty_child, 0, max_wide_levels}};
  while (!stack.empty()) {
    const Pending at = stack.back();
    stack.pop_back();
    const auto index = static_cast<std::uint32_t>(into.nodes.size());
    if (at.parent != empty_child) into.nodes[at.parent].child[at.place] = index;
    WideNode& node = into.nodes.emplace_back();
    node.child.fill(empty_child);
    const Fold folded = fold(tree, at.binary, at.levels_left);
    for (std::uint32_t i = folded.count; i-- > 0;) {  // the last is pushed first, so that the first is numbered first
      const BinaryNode& child = tree[folded.child[i]];
      node.bounds[i] = child.bounds;
      if (child.leaf()) {
        node.child[i] = leaf_child(child.first, child.count);
      } else {
        stack.push_back({folded.child[i], index, i, at.levels_left - 1});
      }
    }
  }
}

void measure_heights(ObjectHierarchy& tree) {
  tree.height.assign(tree.nodes.size(), 0);
  for (std::size_t i = tree.nodes.size(); i-- > 0;) {
    for (const std::uint32_t child : tree.nodes[i].child) {
      if (is_node(child)) tree.height[i] = std::max(tree.height[i], tree.height[child] + 1);
    }
  }
}

}  // namespace

ObjectHierarchy build_object_hierarchy(std::span<const Box> boxes, const HierarchyOptions& options) {
  if (boxes.size() > max_primitives) {
    throw limit_error("object hierarchy", std::to_string(boxes.size()) + " primitives, at most " +
                                              std::to_string(max_primitives) + " can be numbered");
  }
  if (options.leaf_size < 1 || options.leaf_size > max_leaf_size) {
    throw input_error("object hierarchy", "leaf size " + std::to_string(options.leaf_size) + " is not in 1..16");
  }
  ObjectHierarchy result;
  if (boxes.empty()) {
    result.nodes.emplace_back().child.fill(empty_child);
    result.height.assign(1, 0);
    return result;
  }
  BinaryHierarchy binary = build_binary_hierarchy(boxes, options, binary_levels * max_wide_levels);
  result.order = std::move(binary.order);
  result.nodes.reserve(boxes.size() / 8 + 1);
  share_out(binary.nodes.get(), 0);
  collapse(binary.nodes.get(), result);
  measure_heights(result);
  return result;
}

}  // namespace sheaf
