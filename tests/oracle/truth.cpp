// SPDX-License-Identifier: MIT
#include "truth.hpp"

#include <algorithm>
#include <cmath>

namespace oracle {
namespace {

constexpr double reach_factor = 0x1p-20, depth_factor = 0x1p-19;

template <typename Real>
using Vec2 = glm::vec<2, Real>;

template <typename Real>
Real cross2(const Vec2<Real>& a, const Vec2<Real>& b) {
  return a.x * b.y - a.y * b.x;
}

template <typename Real>
Real distance_to_segment(const Vec2<Real>& p, const Vec2<Real>& a, const Vec2<Real>& b) {
  const Vec2<Real> ab = b - a, ap = p - a;
  const Real square = glm::dot(ab, ab);
  const Real along = square > 0 ? std::clamp(glm::dot(ap, ab) / square, Real(0), Real(1)) : Real(0);
  return glm::length(ap - ab * along);
}

/// Inside or on the outline.
template <typename Real>
bool holds(const Vec2<Real> (&corner)[3], const Vec2<Real>& p) {
  const Vec2<Real> a = corner[0] - p, b = corner[1] - p, c = corner[2] - p;
  const Real x = cross2(b, c), y = cross2(c, a), z = cross2(a, b);
  return (x >= 0 && y >= 0 && z >= 0 && x + y + z > 0) || (x <= 0 && y <= 0 && z <= 0 && x + y + z < 0);
}

template <typename Real>
struct Projected {
  Vec2<Real> corner[3];
  Real depth[3];
  Real axis_depth[3];  // t at which the ray has come as far as the corner along its own largest axis
  Real largest = 0;    // coordinate of corner − origin
};

template <typename Real>
Projected<Real> project(const View<Real>& view, const Triangle& triangle) {
  using Vec3 = glm::vec<3, Real>;
  Projected<Real> p;
  const Vec3 a = glm::abs(view.along);
  const int axis = a.x >= a.y && a.x >= a.z ? 0 : a.y >= a.z ? 1 : 2;
  for (int k = 0; k < 3; ++k) {
    const Vec3 q = Vec3(triangle.corner[k]) - view.origin;
    p.corner[k] = {glm::dot(q, view.u), glm::dot(q, view.v)};
    p.depth[k] = glm::dot(q, view.along);
    p.axis_depth[k] = q[axis] / view.along[axis] / view.length;
    p.largest = std::max({p.largest, std::abs(q.x), std::abs(q.y), std::abs(q.z)});
  }
  return p;
}

template <typename Real>
Measured<Real> measure_projected(const Projected<Real>& p, Real length) {
  const Vec2<Real>(&c)[3] = p.corner;
  const Vec2<Real> here(0);
  const Real w[3] = {cross2(c[1], c[2]), cross2(c[2], c[0]), cross2(c[0], c[1])};
  const Real outline = std::min({distance_to_segment(here, c[0], c[1]), distance_to_segment(here, c[1], c[2]),
                                 distance_to_segment(here, c[2], c[0])});
  const Real area = w[0] + w[1] + w[2];
  const Real longest = std::max({glm::length(c[1] - c[0]), glm::length(c[2] - c[1]), glm::length(c[0] - c[2])});
  const Real height = longest > 0 ? std::abs(area) / longest : Real(0);
  const auto [lo, hi] = std::minmax({p.depth[0], p.depth[1], p.depth[2]});
  const Real at_plane = area != 0 ? (w[0] * p.depth[0] + w[1] * p.depth[1] + w[2] * p.depth[2]) / area : p.depth[0];
  Measured<Real> m;
  m.reach = Real(reach_factor) * p.largest;
  m.clearance = holds(c, here) ? outline : -outline;
  m.t = std::clamp(at_plane, lo, hi) / length;
  const Real slope = height > 4 * m.reach ? 4 * m.reach / height : Real(1);
  const auto [near, far] = std::minmax({p.axis_depth[0], p.axis_depth[1], p.axis_depth[2]});
  m.t_error = Real(depth_factor) * (p.largest / length + std::abs(m.t)) + slope * (far - near);
  return m;
}

}  // namespace

template <typename Real>
View<Real>::View(const Ray& ray) : origin(ray.origin) {
  const Vec3 d(ray.direction);
  length = glm::length(d);
  along = d / length;
  const Vec3 a = glm::abs(along);
  const Vec3 least = a.x <= a.y && a.x <= a.z ? Vec3(1, 0, 0) : a.y <= a.z ? Vec3(0, 1, 0) : Vec3(0, 0, 1);
  u = glm::normalize(glm::cross(along, least));
  v = glm::cross(along, u);
}

template <typename Real>
Measured<Real> measure(const View<Real>& view, const Triangle& triangle) {
  return measure_projected(project(view, triangle), view.length);
}

Cover::Cover(std::span<const Triangle> triangles, const Ray& ray) : ray_(ray) {
  const View<double> rough(ray);
  const View<long double> view(ray);
  for (const Triangle& triangle : triangles) {
    const auto p = project(rough, triangle);
    const double margin = 2 * reach_factor * p.largest;
    auto beside = [&](int axis) {
      const auto [lo, hi] = std::minmax({p.corner[0][axis], p.corner[1][axis], p.corner[2][axis]});
      return lo > margin || hi < -margin;
    };
    if (beside(0) || beside(1)) continue;
    const auto exact = project(view, triangle);
    const auto measured = measure_projected(exact, view.length);
    if (measured.clearance < -2 * measured.reach) continue;
    candidates_.push_back({measured, {exact.corner[0], exact.corner[1], exact.corner[2]}});
  }
}

bool Cover::blocks(long double limit, long double limit_error) const {
  std::vector<const Candidate*> sure;
  long double radius = 0;
  for (const Candidate& c : candidates_) {
    const auto& m = c.measured;
    if (!(m.t - m.t_error > ray_.tmin && m.t + m.t_error < limit - limit_error)) continue;
    if (m.clearance > m.reach) return true;
    sure.push_back(&c);
    radius = std::max(radius, m.reach);
  }
  if (sure.empty()) return false;
  constexpr int directions = 64;
  for (int k = 0; k <= directions; ++k) {  // and the middle
    const long double angle = 6.283185307179586477L * (k + 0.37L) / directions, r = k < directions ? radius : 0;
    const glm::vec<2, long double> p(r * std::cos(angle), r * std::sin(angle));
    if (std::none_of(sure.begin(), sure.end(), [&](const Candidate* c) { return holds(c->corner, p); })) return false;
  }
  return true;
}

bool Cover::near_an_outline() const {
  return std::any_of(candidates_.begin(), candidates_.end(),
                     [](const Candidate& c) { return std::abs(c.measured.clearance) <= c.measured.reach; });
}

template struct View<double>;
template struct View<long double>;
template Measured<double> measure(const View<double>&, const Triangle&);
template Measured<long double> measure(const View<long double>&, const Triangle&);

}  // namespace oracle
