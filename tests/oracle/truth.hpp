// SPDX-License-Identifier: MIT
// What is true of a ray and a triangle, in a precision that settles the engine's single-precision answers.
//
// The stated bounds. u = 2^-24; M: largest coordinate of corner − origin, over the triangle. A tracer in single
// precision that shears corners along the ray's largest axis (Woop, Benthin, Wald 2013) rounds corner − origin (u), the
// quotient of the direction's components (at most 5u: Vulkan lets a division err by 2.5 ulps), their product (u) and
// the difference (u of 2M): a coordinate is off by M(1 + 7 + 2)u = 10u·M at most, a point by √2 times that. Hence
//   reach = 2^-20·M: how far from the outline of a triangle, measured across the ray, an answer is free.
// Signs of edge functions must be right for the sheared corners; so a corner's displacement is all there is. At the
// plane,
//   t_error = 2^-19·(M/|d| + |t|) + extent·min(1, 4·reach/h):
// rounding of depths and of the weighted sum; and what the corners' displacement does to the weights, h being the
// triangle's least height as the ray sees it. The weights are of depths along the ray's largest axis, so extent is the
// triangle's along that axis (in units of t), not along the ray: that is what a needle's t errs by, up to its whole
// extent.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <span>
#include <vector>

namespace oracle {

struct Ray {  // as dumped
  glm::vec3 origin;
  float tmin;
  glm::vec3 direction;
  float tmax;
};

struct Hit {  // as dumped
  float t;
  std::int32_t triangle;
  float u, v;
};

struct Triangle {
  glm::vec3 corner[3];
};

template <typename Real>
struct Measured {
  Real t;          // where the ray meets the plane, held to the triangle's extent
  Real t_error;    // the bound above
  Real clearance;  // distance from the outline across the ray; negative outside
  Real reach;      // the bound above
};

/// Axes square to a ray: the triangle is looked at along it.
template <typename Real>
struct View {
  using Vec3 = glm::vec<3, Real>;
  explicit View(const Ray& ray);
  Vec3 origin, u, v, along;  // unit vectors
  Real length;               // of the ray's direction: t counts in it
};

template <typename Real>
Measured<Real> measure(const View<Real>& view, const Triangle& triangle);

/// Triangles that a ray surely meets before `limit`, close ones included, looked for among all of them.
class Cover {
 public:
  Cover(std::span<const Triangle> triangles, const Ray& ray);

  /// True where no displacement of corners within the bounds lets the ray pass: the disc round the ray, as wide as the
  /// bound, is covered by triangles that are met after tmin and before `limit`, each by more than its t_error. One
  /// triangle can do so, or several that share an edge or a corner: a miss between them is a leak.
  [[nodiscard]] bool blocks(long double limit, long double limit_error) const;

  /// Whether the ray passes some triangle's outline within its reach: where an answer is free.
  [[nodiscard]] bool near_an_outline() const;

 private:
  struct Candidate {
    Measured<long double> measured;
    glm::vec<2, long double> corner[3];  // across the ray
  };
  Ray ray_;
  std::vector<Candidate> candidates_;
};

extern template struct View<double>;
extern template struct View<long double>;
extern template Measured<double> measure(const View<double>&, const Triangle&);
extern template Measured<long double> measure(const View<long double>&, const Triangle&);

}  // namespace oracle
