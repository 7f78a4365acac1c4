// SPDX-License-Identifier: MIT
#pragma once

#include "scene/scene.hpp"

namespace sheaf::reference {

/// RGBA at a point, 0…1; white where `use` has no texture. `srgb`: colours are decoded before they are filtered.
[[nodiscard]] glm::dvec4 look_up(const Scene& scene, const TextureUse& use, const glm::dvec2& uv0,
                                 const glm::dvec2& uv1, bool srgb);

}  // namespace sheaf::reference
