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
  constexpr double used = 0.9;  // of the picture's width or height: 5 % stay free on each side
  const bool usable = is_finite(lo) && is_finite(hi) && glm::all(glm::lessThanEqual(lo, hi));
  const glm::dvec3 centre = usable ? lo * 0.5 + hi * 0.5 : glm::dvec3(0);
  glm::dvec3 half = usable ? hi * 0.5 - lo * 0.5 : glm::dvec3(0);
  if (!(glm::length(half) > 0)) half = glm::dvec3(0.5);
  const double size = std::max({half.x, half.y, half.z});
  const double second = half.x + half.y + half.z - size - std::min({half.x, half.y, half.z});

  CameraView view;  // 45° by default
  const double wide = aspect > 0 && std::isfinite(aspect) ? aspect : 1;
  const glm::dvec2 slope = used * view.tan_half_y * glm::dvec2(wide, 1);
  const glm::dvec3 back = glm::normalize(glm::dvec3(0.35, 0.3, 1.0));
  const glm::dvec3 right = glm::normalize(glm::cross(glm::dvec3(0, 1, 0), back));
  const glm::dmat3 axes(right, glm::cross(back, right), back);
  // In units of `size` from the centre, along the camera's axes. A corner p is inside for an eye at (x, y, z) where
  // |p.x − x| ≤ slope.x·(z − p.z), that is x ≥ p.x + slope.x·p.z − slope.x·z and x ≤ p.x − slope.x·p.z + slope.x·z, and
  // so for y: from the least z for which both have a solution on, and at that one two sides touch the margins.
  glm::dvec2 most(-1e300), least(1e300);
  double nearest = -1e300;  // along `back`
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 signs(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
    const glm::dvec3 p = glm::transpose(axes) * (signs * (half / size));
    most = glm::max(most, glm::dvec2(p) + slope * p.z);
    least = glm::min(least, glm::dvec2(p) - slope * p.z);
    nearest = std::max(nearest, p.z);
  }
  const glm::dvec2 distances = (most - least) / (2.0 * slope);
  // All of a flat box that is seen from a low angle may be in sight from its nearest corner, where the eye must not be.
  const double closest = nearest + std::max(second / size / 2, 1e-3);
  const glm::dvec3 eye((most + least) * 0.5, std::max({distances.x, distances.y, closest}));
  view.to_world = rigid(axes, centre + axes * (eye * size));
  return view;
}

}  // namespace sheaf
