// SPDX-License-Identifier: MIT
// What the tests of the reference renderer share: one pixel of a picture, glass, a backdrop that tells where it was
// hit.
#pragma once

#include <gtest/gtest.h>

#include "reference/reference.hpp"
#include "scene_builder.hpp"

namespace sheaf::test {

inline glm::vec4 look(const SceneBuilder& b, const CameraView& view, ReferenceSettings settings = {}) {
  settings.width = settings.height = 1;
  return render_reference(b.scene, b.pose, view, settings).rgba[0];
}

inline void expect_color(const glm::vec4& seen, const glm::dvec3& expected, double tolerance = 1e-6) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen[c], expected[c], tolerance) << "channel " << c;
}

inline Material glass(float ior) {
  Material m;
  m.metallic = 0;
  m.roughness = 0;
  m.transmission = 1;
  m.thickness = 1;
  m.ior = ior;
  return m;
}

/// A backdrop at height z whose unlit red is 0.5 + x / 10 and green 0.5 + y / 10.
inline void add_ramp(SceneBuilder& b, float z) {
  Mesh m = SceneBuilder::floor(z, 5);
  for (const glm::vec3& p : m.positions) m.colors.emplace_back(0.5f + p.x / 10, 0.5f + p.y / 10, 1, 1);
  b.mesh(m, b.unlit(glm::vec3(1)));
}

}  // namespace sheaf::test
