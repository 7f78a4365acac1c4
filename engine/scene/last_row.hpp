// SPDX-License-Identifier: MIT
#pragma once

#include <glm/glm.hpp>

namespace sheaf {

enum class Rounding { none, rounded, impossible };

/// The last row of a matrix that places something is 0 0 0 1. Programs that multiply or invert in single precision, or
/// print few digits, come near it: what is within 1e-4 is made exact.
[[nodiscard]] inline Rounding round_last_row(glm::dmat4& matrix) {
  constexpr double near = 1e-4;
  bool exact = true;
  for (int c = 0; c < 4; ++c) {
    double& value = matrix[c][3];
    const double right = c == 3 ? 1 : 0;
    if (!(glm::abs(value - right) <= near)) return Rounding::impossible;
    exact = exact && value == right;
    value = right;
  }
  return exact ? Rounding::none : Rounding::rounded;
}

}  // namespace sheaf
