// SPDX-License-Identifier: MIT
// Second step: the binary tree is folded to eight children a node by opening, again and again, the child with the
// largest surface, which is the one a ray most likely enters. Children keep the binary tree's order, low side first,
// so the primitives below any node stay consecutive and neighbours in space stay neighbours in `order`.
#include "hierarchy/object_hierarchy.hpp"

#include <algorithm>
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

Fold fold(const BinaryNode* tree, std::uint32_t root, std::uint32_t levels_left) {
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
  collapse(binary.nodes.get(), result);
  measure_heights(result);
  return result;
}

}  // namespace sheaf
