// SPDX-License-Identifier: MIT
// What tests of loaded scenes share: loading what a builder made, points and warnings.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <glm/glm.hpp>

#include "gltf_builder.hpp"
#include "scene/gltf_loader.hpp"

namespace sheaf::test {

inline Scene load(GltfBuilder& builder, const std::string& selector = {}, const LoadLimits& limits = {}) {
  const TempFolder folder;
  return load_gltf(folder.write("scene.gltf", builder.text()), {selector, {}}, limits);
}

/// A mesh's vertex in object space.
inline glm::dvec3 vertex(const Mesh& mesh, std::size_t i) { return mesh.centre + glm::dvec3(mesh.positions[i]); }

inline void expect_near(const glm::dvec3& a, const glm::dvec3& b, double tolerance = 1e-6) {
  EXPECT_LT(glm::distance(a, b), tolerance)
      << a.x << " " << a.y << " " << a.z << " is not " << b.x << " " << b.y << " " << b.z;
}

inline bool warns(const Scene& scene, const std::string& text) {
  return std::ranges::any_of(scene.warnings, [&](const auto& line) { return line.find(text) != std::string::npos; });
}

inline std::string all_of(const std::vector<std::string>& lines) {
  std::string out;
  for (const auto& line : lines) out += line + "\n";
  return out;
}

/// Whatever was sloppy, the triangle is the one that was written.
inline void expect_triangle(const Scene& scene) {
  ASSERT_EQ(scene.meshes.size(), 1u);
  ASSERT_EQ(scene.meshes[0].positions.size(), 3u);
  for (std::size_t v = 0; v < 3; ++v) {
    const glm::dvec3 p = glm::dvec3(scene.meshes[0].positions[v]) + scene.meshes[0].centre;
    for (int c = 0; c < 3; ++c) EXPECT_EQ(p[c], unit_triangle[3 * v + static_cast<std::size_t>(c)]) << "vertex " << v;
  }
  EXPECT_TRUE(scene.nodes[0].matrix == glm::dmat4(1));
}

}  // namespace sheaf::test
