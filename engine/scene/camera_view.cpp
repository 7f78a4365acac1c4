// SPDX-License-Identifier: MIT
// Views that need no path: a camera of the scene, and the whole scene framed.
#include <algorithm>
#include <cmath>

#include "scene/camera_path.hpp"
#include "scene/rigid.hpp"

namespace sheaf {
namespace {

glm::dmat4 rigid(const glm::dmat3& rotation, const glm::dvec3& position) {
  glm::dmat4 m(rotation);
  m[3] = glm::dvec4(position, 1);
  return m;
}

bool is_finite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

}  // namespace

CameraView view_of(const Camera& camera, const glm::dmat4& node_to_world, double) {
  CameraView view;
  view.to_world = rigid(orthonormal_basis(glm::dmat3(node_to_world)), glm::dvec3(node_to_world[3]));
  view.orthographic = camera.orthographic;
  view.tan_half_y = std::tan(camera.yfov / 2);
  view.half_height = camera.ymag;
  view.near = camera.near;
  view.far = camera.far;
  return view;
}

CameraView framing_view(const glm::dvec3& lo, const glm::dvec3& hi, double aspect) {
  constexpr double margin = 1.05;
  const bool usable = is_finite(lo) && is_finite(hi) && glm::all(glm::lessThanEqual(lo, hi));
  const glm::dvec3 centre = usable ? lo * 0.5 + hi * 0.5 : glm::dvec3(0);
  double radius = usable ? glm::length(hi * 0.5 - lo * 0.5) : 0;
  if (!(radius > 0)) radius = std::sqrt(3.0) / 2;  // of a cube of 1 m

  CameraView view;  // 45° by default
  const double wide = aspect > 0 && std::isfinite(aspect) ? aspect : 1;
  // The sphere touches the cone of the narrower axis where sin(half angle) = radius / distance.
  const double half = std::atan(view.tan_half_y * std::min(1.0, wide));
  const glm::dvec3 back = glm::normalize(glm::dvec3(0.35, 0.3, 1.0));
  const glm::dvec3 x = glm::normalize(glm::cross(glm::dvec3(0, 1, 0), back));
  view.to_world = rigid({x, glm::cross(back, x), back}, centre + back * (margin * radius / std::sin(half)));
  return view;
}

}  // namespace sheaf
