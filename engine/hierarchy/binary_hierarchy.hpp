// SPDX-License-Identifier: MIT
// First step of the object hierarchy: a binary tree by binned surface area heuristic (Wald 2007), of bounded height.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "hierarchy/object_hierarchy.hpp"

namespace sheaf {

struct BinaryNode {
  Box bounds;
  std::uint32_t first, count;  // primitives below, consecutive in `order`
  std::uint32_t left;          // the right child follows it; 0: a leaf (the root is nobody's child)
  std::uint32_t height;        // edges down to the deepest leaf
  std::uint32_t shares = 0;    // how its children share what roots a wide node has left (object_hierarchy.cpp)
  [[nodiscard]] bool leaf() const { return left == 0; }
};

struct BinaryHierarchy {
  std::unique_ptr<BinaryNode[]> nodes;  // 0 = root; places may be unused
  std::vector<std::uint32_t> order;
};

/// `max_height` must leave room for a balanced tree: 2^max_height * leaf_size >= boxes. Needs at least one box.
[[nodiscard]] BinaryHierarchy build_binary_hierarchy(std::span<const Box> boxes, const HierarchyOptions& options,
                                                     std::uint32_t max_height);

}  // namespace sheaf
