// SPDX-License-Identifier: MIT
// The fold of a binary tree to eight children a node against every way there is.
#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <vector>

#include "hierarchy/binary_hierarchy.hpp"
#include "hierarchy/object_hierarchy.hpp"

namespace sheaf {
namespace {

double half_area(const Box& box) {
  const glm::dvec3 d = glm::dvec3(box.hi) - glm::dvec3(box.lo);
  return d.x * d.y + d.y * d.z + d.z * d.x;
}

class EveryWay {
 public:
  explicit EveryWay(const BinaryNode* tree) : tree_(tree) {}

  /// The least sum of the surfaces of all wide nodes from `at` on.
  [[nodiscard]] double node(std::uint32_t at) const {
    if (tree_[at].leaf()) return 0;
    return half_area(tree_[at].bounds) + children({tree_[at].left, tree_[at].left + 1}, 0);
  }

 private:
  // Of what is to be decided each is kept as a child or opened, while there is room.
  [[nodiscard]] double children(std::vector<std::uint32_t> open, std::size_t kept) const {
    if (open.empty()) return 0;
    const std::uint32_t at = open.back();
    open.pop_back();
    double best = node(at) + children(open, kept + 1);
    if (!tree_[at].leaf() && kept + open.size() + 2 <= wide) {
      open.push_back(tree_[at].left);
      open.push_back(tree_[at].left + 1);
      best = std::min(best, children(open, kept));
    }
    return best;
  }

  const BinaryNode* tree_;
};

double surfaces(const ObjectHierarchy& tree, const Box& whole) {
  double sum = half_area(whole);
  for (const auto& node : tree.nodes)
    for (std::uint32_t c = 0; c < wide; ++c)
      if (is_node(node.child[c])) sum += half_area(node.bounds[c]);
  return sum;
}

TEST(HierarchyFold, NoWayHasLessSurface) {
  HierarchyOptions options;
  options.leaf_size = 1;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> place(0, 1), size(0, 0.3F);
    std::vector<Box> boxes;
    for (std::uint32_t i = 0; i < 9 + seed % 8; ++i) {
      const glm::vec3 p(place(random), place(random), place(random));
      boxes.push_back({p, p + glm::vec3(size(random), size(random), size(random))});
    }
    const auto binary = build_binary_hierarchy(boxes, options, 48);
    const double best = EveryWay(binary.nodes.get()).node(0);
    EXPECT_NEAR(surfaces(build_object_hierarchy(boxes, options), binary.nodes[0].bounds), best, 1e-5 * best) << seed;
  }
}

}  // namespace
}  // namespace sheaf
