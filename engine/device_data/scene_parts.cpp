// SPDX-License-Identifier: MIT
#include "device_data/scene_parts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <tuple>

namespace sheaf {
namespace {

struct Open {
  double area = 0;  // in the world
  std::uint32_t instance = 0, child = 0;
  Box box;
  // The largest first; of equal ones the first instance's first, so that the choice is one.
  bool operator<(const Open& other) const {
    return std::tuple(area, other.instance, other.child) < std::tuple(other.area, instance, child);
  }
};

double half_area(const Box& box) {
  const glm::dvec3 d = glm::dvec3(box.hi) - glm::dvec3(box.lo);
  const double area = d.x * d.y + d.y * d.z + d.z * d.x;
  return std::isfinite(area) ? area : std::numeric_limits<double>::max();
}

bool overlap(const Box& a, const Box& b) {
  return glm::all(glm::lessThan(a.lo, b.hi)) && glm::all(glm::lessThan(b.lo, a.hi));
}

// Boxes of instances, to find those that overlap another's part.
class Neighbours {
 public:
  explicit Neighbours(std::span<const PartedInstance> instances) {
    boxes_.reserve(instances.size());
    for (const auto& i : instances) boxes_.push_back(transformed(i.box, i.to_world));
    HierarchyOptions options;
    options.leaf_size = 1;
    tree_ = build_object_hierarchy(boxes_, options);
  }

  [[nodiscard]] bool any(const Box& box, std::uint32_t own) const {
    std::vector<std::uint32_t> todo{0};
    while (!todo.empty()) {
      const WideNode& node = tree_.nodes[todo.back()];
      todo.pop_back();
      for (std::uint32_t c = 0; c < wide; ++c) {
        if (node.child[c] == empty_child || !overlap(node.bounds[c], box)) continue;
        if (is_node(node.child[c]))
          todo.push_back(node.child[c]);
        else if (tree_.order[leaf_first(node.child[c])] != own)
          return true;
      }
    }
    return false;
  }

 private:
  std::vector<Box> boxes_;
  ObjectHierarchy tree_;
};

// Half the surface of its nodes.
double top_level_area(std::span<const PartedInstance> instances, std::span<const ScenePart> parts) {
  std::vector<Box> boxes;
  boxes.reserve(parts.size());
  for (const auto& part : parts) boxes.push_back(transformed(part.box, instances[part.instance].to_world));
  HierarchyOptions options;
  options.leaf_size = 1;
  const ObjectHierarchy tree = build_object_hierarchy(boxes, options);
  Box whole;
  double area = 0;
  for (const auto& node : tree.nodes)
    for (std::uint32_t c = 0; c < wide; ++c)
      if (is_node(node.child[c])) area += half_area(node.bounds[c]);
  for (const auto& box : boxes) {
    whole.lo = glm::min(whole.lo, box.lo);
    whole.hi = glm::max(whole.hi, box.hi);
  }
  return boxes.empty() ? 0 : area + half_area(whole);
}

}  // namespace

Box transformed(const Box& box, const glm::dmat4& m) {
  Box result;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec4 p(corner & 1 ? box.hi.x : box.lo.x, corner & 2 ? box.hi.y : box.lo.y,
                       corner & 4 ? box.hi.z : box.lo.z, 1);
    const glm::vec3 q(glm::dvec3(m * p));
    result.lo = glm::min(result.lo, q);
    result.hi = glm::max(result.hi, q);
  }
  return result;
}

SceneParts open_parts(std::span<const PartedInstance> instances, std::size_t most) {
  SceneParts result;
  result.above.resize(instances.size());
  std::priority_queue<Open> open;
  const Neighbours neighbours(instances);
  const auto offer = [&](std::uint32_t i, std::uint32_t child, const Box& box) {
    const Box world = transformed(box, instances[i].to_world);
    if (is_node(child) && !instances[i].whole && neighbours.any(world, i))
      open.push({half_area(world), i, child, box});
    else
      result.parts.push_back({i, child, box});
  };
  for (std::uint32_t i = 0; i < instances.size(); ++i) offer(i, 0, instances[i].box);
  while (!open.empty() && open.size() + result.parts.size() + wide - 1 <= most) {
    const Open at = open.top();
    open.pop();
    result.area -= at.area;
    result.above[at.instance].push_back(at.child);
    const WideNode& node = instances[at.instance].tree->nodes[at.child];
    for (std::uint32_t c = 0; c < wide; ++c)
      if (node.child[c] != empty_child) offer(at.instance, node.child[c], node.bounds[c]);
  }
  for (; !open.empty(); open.pop()) result.parts.push_back({open.top().instance, open.top().child, open.top().box});
  std::sort(result.parts.begin(), result.parts.end(), [](const ScenePart& a, const ScenePart& b) {
    return std::tuple(a.instance, a.child) < std::tuple(b.instance, b.child);
  });
  for (auto& nodes : result.above) std::sort(nodes.begin(), nodes.end());
  result.area += top_level_area(instances, result.parts);
  return result;
}

SceneParts choose_parts(std::span<const PartedInstance> instances, std::size_t most) {
  SceneParts best = open_parts(instances, 0);
  for (const std::size_t share : {16U, 4U, 1U}) {
    SceneParts parted = open_parts(instances, most / share);
    if (parted.area < best.area) best = std::move(parted);
  }
  return best;
}

}  // namespace sheaf
