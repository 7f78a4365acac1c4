// SPDX-License-Identifier: MIT
// The object hierarchy: a tree of boxes, eight children a node, over triangles (one tree a mesh) or over instances
// (the top level). Built on the CPU by the surface area heuristic; the device walks it and refits it.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <span>
#include <vector>

namespace sheaf {

struct Box {
  glm::vec3 lo{std::numeric_limits<float>::max()}, hi{-std::numeric_limits<float>::max()};  // inverted: holds nothing
};

inline constexpr std::uint32_t wide = 8;              // children a node
inline constexpr std::uint32_t max_wide_levels = 16;  // of any tree: bounds every traversal stack
inline constexpr std::uint32_t max_leaf_size = 16;
inline constexpr std::uint32_t max_primitives = 1u << 27;

// A child reference, shared with the shaders: all ones = empty; top bit set = leaf, bits 27..30 = count - 1,
// bits 0..26 = first primitive (a place in `order`); else a node's index. The one leaf that would read as empty, 16
// primitives from place 2^27 - 1, cannot exist.
inline constexpr std::uint32_t empty_child = 0xFFFFFFFFu;
inline constexpr std::uint32_t leaf_bit = 0x80000000u;

[[nodiscard]] constexpr std::uint32_t leaf_child(std::uint32_t first, std::uint32_t count) {
  return leaf_bit | ((count - 1) << 27) | first;
}
[[nodiscard]] constexpr bool is_leaf(std::uint32_t child) { return child != empty_child && (child & leaf_bit) != 0; }
[[nodiscard]] constexpr bool is_node(std::uint32_t child) { return (child & leaf_bit) == 0; }
[[nodiscard]] constexpr std::uint32_t leaf_first(std::uint32_t child) { return child & (max_primitives - 1); }
[[nodiscard]] constexpr std::uint32_t leaf_count(std::uint32_t child) { return ((child >> 27) & 15u) + 1; }

struct WideNode {
  std::array<std::uint32_t, wide> child;
  std::array<Box, wide> bounds;  // inverted for empty children, which come last
};

struct ObjectHierarchy {
  std::vector<std::uint32_t> order;   // new place -> old primitive; the primitives below a node are consecutive
  std::vector<WideNode> nodes;        // 0 = root; depth first: a child's index is greater than its parent's
  std::vector<std::uint32_t> height;  // a node: 0 where no child is a node, else 1 + the most of its child nodes.
                                      // Refitting all nodes of height 0, then of 1, ... needs no other order.
};

struct HierarchyOptions {
  std::uint32_t leaf_size = 4;  // at most so many primitives a leaf, 1..16
  float traversal_cost = 1;     // of one step down a binary tree, against
  float intersection_cost = 1;  // one primitive's test
  std::uint32_t threads = 2;    // the result does not depend on it
};

/// Boxes may be of any size, even infinite, but not NaN. No box: one node whose children are all empty.
/// At most `max_wide_levels` levels whatever the boxes. Throws Error{limit} past `max_primitives`.
[[nodiscard]] ObjectHierarchy build_object_hierarchy(std::span<const Box> boxes, const HierarchyOptions& options = {});

}  // namespace sheaf
