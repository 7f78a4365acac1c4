// SPDX-License-Identifier: MIT
// Rotations out of numbers that are only nearly rotations.
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

namespace sheaf {

[[nodiscard]] inline glm::dquat unit_or_identity(const glm::dquat& q) {
  const double length = glm::length(q);
  return length > 0 ? q / length : glm::dquat(1, 0, 0, 0);
}

/// A right-handed orthonormal basis near the columns of `m`: -Z first, since cameras look along it, then +Y as near as
/// it can be. Columns without length are replaced by any direction that fits. A reflection loses its x axis.
[[nodiscard]] inline glm::dmat3 orthonormal_basis(const glm::dmat3& m) {
  const auto unit = [](const glm::dvec3& v, const glm::dvec3& otherwise) {
    const double length = glm::length(v);
    return length > 0 ? v / length : otherwise;
  };
  const glm::dvec3 z = unit(m[2], unit(glm::cross(m[0], m[1]), {0, 0, 1}));
  const glm::dvec3 any = glm::abs(z.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
  const glm::dvec3 from_y = m[1] - z * glm::dot(z, m[1]), from_x = glm::cross(z, m[0]);
  const double scale = glm::length(m[1]);
  const bool y_fits = glm::length(from_y) > 1e-12 * scale && scale > 0;
  const glm::dvec3 y = unit(y_fits ? from_y : from_x - z * glm::dot(z, from_x), unit(any - z * glm::dot(z, any), any));
  return {glm::cross(y, z), y, z};
}

}  // namespace sheaf
