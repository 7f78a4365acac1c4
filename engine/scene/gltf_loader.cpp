// SPDX-License-Identifier: MIT
#include "scene/gltf_loader.hpp"

#include <new>

#include "scene/gltf_file.hpp"
#include "scene/gltf_material.hpp"
#include "scene/gltf_mesh.hpp"
#include "scene/gltf_nodes.hpp"

namespace sheaf {
namespace {

// Meshes that no node of the chosen scene shows are never read.
std::vector<bool> meshes_in_use(const GltfFile& file, const Scene& scene) {
  std::vector<bool> used(file.model.meshes.size(), false);
  for (const std::uint32_t node : scene.order) {
    if (const int mesh = file.model.nodes[node].mesh; mesh >= 0) used[static_cast<std::size_t>(mesh)] = true;
  }
  return used;
}

Scene build_scene(GltfFile& file, const std::string& scene_selector) {
  Scene scene;
  scene.path = file.path;
  scene.sha256 = file.sha256;
  load_cameras(file, scene);
  load_lights(file, scene);
  load_nodes(file, scene);
  select_scene(file, scene_selector, scene);
  load_materials(file, scene);
  const std::vector<MeshEntry> meshes = load_meshes(file, meshes_in_use(file, scene), scene);
  bind_meshes(file, meshes, scene);
  load_animations(file, meshes, scene);
  scene.warnings = std::move(file.warnings);
  scene.extensions_ignored = std::move(file.extensions_ignored);
  return scene;
}

}  // namespace

Scene load_gltf(const std::string& path, const std::string& scene_selector, const LoadLimits& limits) {
  try {
    GltfFile file = open_gltf(path, limits);
    return build_scene(file, scene_selector);
  } catch (const std::bad_alloc&) {
    throw limit_error(path, "does not fit in memory");
  } catch (const nlohmann::json::exception& error) {
    throw input_error(path, std::string("unexpected JSON: ") + error.what());
  }
}

}  // namespace sheaf
