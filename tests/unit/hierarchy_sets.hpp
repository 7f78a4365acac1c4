// SPDX-License-Identifier: MIT
// Boxes to build an object hierarchy over: of every kind that a scene, or a broken one, may hold.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "hierarchy/object_hierarchy.hpp"

namespace sheaf::test {

using Boxes = std::vector<Box>;

inline Box around(glm::vec3 middle, glm::vec3 half) { return {middle - half, middle + half}; }

using Source = std::function<Boxes(std::uint32_t)>;

struct Set {
  std::string name;
  Source make;
};

inline glm::vec3 random_point(std::mt19937& random) {
  std::uniform_real_distribution<float> unit(-1, 1);
  const float x = unit(random), y = unit(random), z = unit(random);
  return {x, y, z};
}

inline Boxes generate(std::uint32_t count, const std::function<Box(std::mt19937&, std::uint32_t)>& one) {
  std::mt19937 random(count * 7919 + 1);
  Boxes boxes;
  for (std::uint32_t i = 0; i < count; ++i) boxes.push_back(one(random, i));
  return boxes;
}

inline std::vector<Set> sets() {
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

}  // namespace sheaf::test
