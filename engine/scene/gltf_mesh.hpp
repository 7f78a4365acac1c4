// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "scene/gltf_accessor.hpp"
#include "scene/gltf_file.hpp"
#include "scene/scene.hpp"

namespace sheaf {

/// What became of one glTF mesh.
struct MeshEntry {
  std::uint32_t first = 0, count = 0;  // in Scene::meshes
  std::uint32_t targets = 0;           // morph targets
  std::uint32_t joints = 0;            // a skin needs at least that many; 0: not skinned
  std::vector<double> weights;         // rest weights, one a target
};

/// Reads the primitives of the meshes marked in `wanted`. Scene::materials must be there.
[[nodiscard]] std::vector<MeshEntry> load_meshes(GltfFile& file, const std::vector<bool>& wanted, Scene& scene);

}  // namespace sheaf
