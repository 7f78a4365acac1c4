// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "scene/scene.hpp"
#include "settings/render_settings.hpp"

namespace sheaf {

struct SceneLayout;

/// Fills materials (volumes first, so that volume n is material n − 1), textures and texels. Returns, for each material
/// of the scene, its place. Throws Error{limit} for more than 255 volumes.
std::vector<std::uint32_t> lay_out_materials(const Scene& scene, const RenderSettings& settings, SceneLayout& layout);

}  // namespace sheaf
