// SPDX-License-Identifier: MIT
// Rays against triangles in double precision.
#pragma once

#include <functional>
#include <span>

#include "hierarchy/object_hierarchy.hpp"
#include "reference/reference.hpp"

namespace sheaf::reference {

struct Ray {
  glm::dvec3 origin, direction;  // unit direction
  double tmin = 0, tmax = std::numeric_limits<double>::infinity();
};

struct Hit {
  std::uint32_t triangle = none;
  double t = 0;
  double order = 0;           // hits are met in this order: t, but for surfaces with ranks
  glm::dvec3 barycentric{0};  // weights of v[0], v[1], v[2]
};

struct Tests {
  std::uint64_t boxes = 0, triangles = 0;
};

/// Edges and vertices belong to every triangle they touch; a triangle without area is never hit.
[[nodiscard]] bool intersect(const Ray& ray, const ReferenceTriangle& triangle, Hit& hit);

class Tracer {
 public:
  explicit Tracer(std::span<const ReferenceTriangle> triangles, std::uint32_t threads = 1);

  /// The first of the hits that `accepts` lets count, which may set their order, not below t; those that differ by at
  /// most one ulp are equal, and the lowest triangle is taken. triangle == none: a miss.
  using Accepts = std::function<bool(Hit&)>;
  [[nodiscard]] Hit closest(const Ray& ray, const Accepts& accepts, Tests& tests) const;

  /// Every hit once, in no order, until `visit` returns false.
  void for_each_hit(const Ray& ray, const std::function<bool(const Hit&)>& visit, Tests& tests) const;

 private:
  template <class Visit>  // visit(hit): no hit with t beyond the number it returns matters any more
  void walk(const Ray& ray, Tests& tests, const Visit& visit) const;

  std::span<const ReferenceTriangle> triangles_;
  ObjectHierarchy tree_;
};

}  // namespace sheaf::reference
