// SPDX-License-Identifier: MIT
// Views of a scene's own cameras, and of scenes that have none.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#define GLM_ENABLE_EXPERIMENTAL
#include <glm/gtx/string_cast.hpp>

#include "scene/camera_path.hpp"

namespace sheaf {
namespace {

void expect_near(const glm::dvec3& a, const glm::dvec3& b, double tolerance = 1e-9) {
  EXPECT_LT(glm::distance(a, b), tolerance)
      << a.x << " " << a.y << " " << a.z << " is not " << b.x << " " << b.y << " " << b.z;
}

TEST(CameraView, OfASceneCameraDropsScale) {
  Camera camera;
  camera.yfov = 1;
  const glm::dmat4 node = glm::scale(glm::rotate(glm::translate(glm::dmat4(1), {1, 2, 3}), 0.3, {0, 1, 0}), {2, 5, 7});
  const CameraView view = view_of(camera, node, 1.5);
  const glm::dmat4 expected = glm::rotate(glm::translate(glm::dmat4(1), {1, 2, 3}), 0.3, {0, 1, 0});
  for (int c = 0; c < 4; ++c) expect_near(glm::dvec3(view.to_world[c]), glm::dvec3(expected[c]));
  EXPECT_NEAR(view.tan_half_y, std::tan(0.5), 1e-15);
}

// The corners' places in the picture, −1 … 1 on both axes: the least and the largest.
struct Extent {
  glm::dvec2 lo{1e300}, hi{-1e300};
};

Extent extent_of(const CameraView& view, const glm::dvec3& lo, const glm::dvec3& hi, double aspect) {
  Extent extent;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p(corner & 1 ? hi.x : lo.x, corner & 2 ? hi.y : lo.y, corner & 4 ? hi.z : lo.z);
    const glm::dvec3 q = glm::transpose(glm::dmat3(view.to_world)) * (p - glm::dvec3(view.to_world[3]));
    EXPECT_LT(q.z, 0);
    const glm::dvec2 at = glm::dvec2(q) / -q.z / (view.tan_half_y * glm::dvec2(aspect, 1));
    extent.lo = glm::min(extent.lo, at);
    extent.hi = glm::max(extent.hi, at);
  }
  return extent;
}

// 5 % of the picture stays free on each side, no more on two opposite ones, and what is left over is shared equally.
TEST(CameraView, FramingFillsThePicture) {
  const std::array<std::array<glm::dvec3, 2>, 9> boxes{{{{{-1, -1, -1}, {1, 1, 1}}},
                                                        {{{1e6, -3, 2}, {1e6 + 5, 4, 2.5}}},
                                                        {{{0, 0, 0}, {1, 100, 1}}},
                                                        {{{-50, 0, -1}, {50, 1, 1}}},
                                                        {{{0, 0, -1e3}, {1, 1, 1e3}}},
                                                        {{{-1, 2, -1}, {1, 2, 1}}},
                                                        {{{-1, -1, 3}, {1, 1, 3}}},
                                                        {{{1e-12, 0, 0}, {2e-12, 3e-12, 1e-12}}},
                                                        {{{-1e30, -1e30, -2e30}, {1e30, 2e30, 1e30}}}}};
  for (const auto& [lo, hi] : boxes) {
    for (const double aspect : {9.0 / 16, 1.0, 16.0 / 9, 0.05, 30.0}) {
      const Extent e = extent_of(framing_view(lo, hi, aspect), lo, hi, aspect);
      EXPECT_LT(std::max({-e.lo.x, -e.lo.y, e.hi.x, e.hi.y}), 0.9 + 1e-7) << glm::to_string(hi) << " at " << aspect;
      // From low above a floor all of it is in sight long before it fills a very wide picture.
      if (lo.y == hi.y && aspect > 2) continue;
      const double near = 1e-7;  // of rounding: the second box is as far away as it is fine
      EXPECT_NEAR(std::max(e.hi.x, e.hi.y), 0.9, near) << glm::to_string(hi) << " at " << aspect;
      const int axis = e.hi.x > e.hi.y ? 0 : 1;
      EXPECT_NEAR(e.lo[axis], -0.9, near);
      EXPECT_GE(e.lo[1 - axis], -0.9 - near);
    }
  }
}

TEST(CameraView, FramingAPointOrNothing) {
  const CameraView point = framing_view({5, 5, 5}, {5, 5, 5}, 1),
                   empty = framing_view(glm::dvec3(1), glm::dvec3(-1), 1);
  EXPECT_GT(glm::distance(glm::dvec3(point.to_world[3]), glm::dvec3(5)), 1);
  EXPECT_TRUE(std::isfinite(empty.to_world[3].z));
}

}  // namespace
}  // namespace sheaf
