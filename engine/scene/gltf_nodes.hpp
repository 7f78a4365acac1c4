// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "scene/gltf_mesh.hpp"

namespace sheaf {

/// Nodes with their transforms, parents, cameras and lights; no meshes and skins yet.
void load_nodes(GltfFile& file, Scene& scene);

/// Cameras and KHR_lights_punctual.
void load_cameras(GltfFile& file, Scene& scene);
void load_lights(GltfFile& file, Scene& scene);

/// Chooses the glTF scene (by name, by index, the file's default, the first) and fills Scene::roots and order.
void select_scene(GltfFile& file, const std::string& selector, Scene& scene);

/// What KHR_node_visibility hides, with all that hangs from it, has no mesh and no light.
void hide_nodes(Scene& scene);

/// Warns of MSFT_lod: coarser levels are not used.
void report_levels_of_detail(const GltfFile& file, const Scene& scene);

/// Ties nodes to what their meshes became, and reads skins, rest weights and instances.
void bind_meshes(GltfFile& file, const std::vector<MeshEntry>& meshes, Scene& scene);

void load_animations(GltfFile& file, const std::vector<MeshEntry>& meshes, Scene& scene);

}  // namespace sheaf
