// SPDX-License-Identifier: MIT
#include "device_data/scene_parts.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <random>

namespace sheaf {
namespace {

struct Built {
  ObjectHierarchy tree;
  Box box;
};

// Small boxes strewn over a cube of this size.
Built strewn(std::uint32_t count, float size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> place(0, size);
  std::vector<Box> boxes;
  Built built;
  for (std::uint32_t i = 0; i < count; ++i) {
    const glm::vec3 p(place(random), place(random), place(random));
    boxes.push_back({p, p + 0.01F * size});
    built.box.lo = glm::min(built.box.lo, boxes.back().lo);
    built.box.hi = glm::max(built.box.hi, boxes.back().hi);
  }
  built.tree = build_object_hierarchy(boxes);
  return built;
}

void collect(const ObjectHierarchy& tree, std::uint32_t child, std::vector<std::uint32_t>& found) {
  if (child == empty_child) return;
  if (is_leaf(child)) {
    for (std::uint32_t i = 0; i < leaf_count(child); ++i) found.push_back(leaf_first(child) + i);
    return;
  }
  for (const auto c : tree.nodes[child].child) collect(tree, c, found);
}

void collect_above(const ObjectHierarchy& tree, std::span<const std::uint32_t> above, std::uint32_t child,
                   std::vector<std::uint32_t>& met) {
  if (child == empty_child || is_leaf(child) || !std::binary_search(above.begin(), above.end(), child)) return;
  met.push_back(child);
  for (const auto c : tree.nodes[child].child) collect_above(tree, above, c, met);
}

// Every primitive of every instance below exactly one part, in order of instances; nodes above hang together from the
// root.
void expect_whole(std::span<const PartedInstance> instances, const SceneParts& chosen) {
  ASSERT_TRUE(std::is_sorted(chosen.parts.begin(), chosen.parts.end(),
                             [](const auto& a, const auto& b) { return a.instance < b.instance; }));
  for (std::uint32_t i = 0; i < instances.size(); ++i) {
    std::vector<std::uint32_t> found, met;
    for (const auto& part : chosen.parts)
      if (part.instance == i) collect(*instances[i].tree, part.child, found);
    std::sort(found.begin(), found.end());
    ASSERT_EQ(found.size(), instances[i].tree->order.size());
    for (std::uint32_t k = 0; k < found.size(); ++k) ASSERT_EQ(found[k], k);
    collect_above(*instances[i].tree, chosen.above[i], 0, met);
    EXPECT_EQ(met.size(), chosen.above[i].size());
  }
}

TEST(SceneParts, OverlappingInstancesAreOpenedUpToTheMost) {
  const Built a = strewn(3000, 1, 1), b = strewn(2000, 1, 2);
  const std::array instances{PartedInstance{&a.tree, a.box}, PartedInstance{&b.tree, b.box}};
  for (const std::size_t most : {0U, 2U, 8U, 9U, 100U, 1000U, 100000U}) {
    const SceneParts chosen = open_parts(instances, most);
    EXPECT_LE(chosen.parts.size(), std::max<std::size_t>(most, 2));
    EXPECT_GE(chosen.parts.size() + wide, std::min<std::size_t>(most, 500));
    expect_whole(instances, chosen);
  }
}

TEST(SceneParts, WhatNothingElseReachesStaysWhole) {
  const Built a = strewn(3000, 1, 1), b = strewn(2000, 1, 2);
  const auto aside = glm::translate(glm::dmat4(1), glm::dvec3(5, 0, 0));
  const std::array apart{PartedInstance{&a.tree, a.box}, PartedInstance{&b.tree, b.box, aside}};
  EXPECT_EQ(open_parts(apart, 1000).parts.size(), 2U);
  const std::array alone{PartedInstance{&a.tree, a.box}};
  EXPECT_EQ(open_parts(alone, 1000).parts.size(), 1U);
  EXPECT_TRUE(open_parts({}, 1000).parts.empty());
}

TEST(SceneParts, DeformingInstancesStayWhole) {
  const Built a = strewn(3000, 1, 1), b = strewn(2000, 1, 2);
  const std::array instances{PartedInstance{&a.tree, a.box}, PartedInstance{&b.tree, b.box, glm::dmat4(1), true}};
  const SceneParts chosen = open_parts(instances, 1000);
  EXPECT_TRUE(chosen.above[1].empty());
  EXPECT_EQ(std::count_if(chosen.parts.begin(), chosen.parts.end(), [](const auto& p) { return p.instance == 1; }), 1);
  EXPECT_GT(chosen.parts.size(), 500U);
  expect_whole(instances, chosen);
}

TEST(SceneParts, TheLeastSurfaceIsChosen) {
  const Built a = strewn(3000, 1, 1), b = strewn(20, 1, 2);
  bool whole = false, parted = false;
  for (const double offset : {0.0, 0.5, 0.9, 0.99}) {
    const auto beside = glm::translate(glm::dmat4(1), glm::dvec3(offset, 0, 0));
    const std::array instances{PartedInstance{&a.tree, a.box}, PartedInstance{&b.tree, b.box, beside},
                               PartedInstance{&b.tree, b.box, beside}};
    const SceneParts chosen = choose_parts(instances, 1024);
    expect_whole(instances, chosen);
    for (const std::size_t most : {0U, 64U, 256U, 1024U}) EXPECT_LE(chosen.area, open_parts(instances, most).area);
    (chosen.parts.size() == 3 ? whole : parted) = true;
  }
  EXPECT_TRUE(parted);
  const auto aside = glm::translate(glm::dmat4(1), glm::dvec3(0.9999, 0, 0));
  const std::array few{PartedInstance{&b.tree, b.box}, PartedInstance{&b.tree, b.box, aside}};
  whole = whole || choose_parts(few, 1024).parts.size() == 2;
  EXPECT_TRUE(whole);
}

TEST(SceneParts, HugeAndFlatBoxesEnd) {
  Built a = strewn(100, 1, 1), b = strewn(100, 1, 2);
  a.box = {glm::vec3(-3e38F), glm::vec3(3e38F)};
  b.box = {glm::vec3(0.5F), glm::vec3(0.5F)};
  const std::array instances{PartedInstance{&a.tree, a.box}, PartedInstance{&b.tree, b.box}};
  expect_whole(instances, open_parts(instances, 50));
}

}  // namespace
}  // namespace sheaf
