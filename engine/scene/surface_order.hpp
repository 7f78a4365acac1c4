// SPDX-License-Identifier: MIT
// The order of surfaces in one place: by kind, then by what they look like, then by their shape.
#pragma once

#include <cstdint>
#include <vector>

#include "scene/coincident.hpp"

namespace sheaf {

enum class SurfaceKind : std::uint32_t { blended, masked, thin, opaque, volume };

[[nodiscard]] SurfaceKind kind_of(const Material& material, const SurfaceView& view);

/// Numbers that tell surfaces apart by what they are; compared in turn. Equal ones give equal pictures in any order.
/// The order of vertices, how a mesh is cut into triangles and the places of objects in the file have no part in them.
[[nodiscard]] std::vector<double> content_of(const Scene& scene, const Material& material, const Mesh& mesh,
                                             const glm::dmat4& world, const SurfaceView& view);

}  // namespace sheaf
