// SPDX-License-Identifier: MIT
#include "scene/gltf_loader.hpp"

#include <new>

#include "scene/gltf_file.hpp"
#include "scene/gltf_material.hpp"
#include "scene/gltf_mesh.hpp"
#include "scene/gltf_nodes.hpp"
#include "scene/gltf_variants.hpp"

namespace sheaf {
namespace {

// Meshes that no visible node of the chosen scene has are never read.
std::vector<bool> meshes_in_use(const GltfFile& file, const Scene& scene) {
  std::vector<bool> used(file.model.meshes.size(), false);
  for (const std::uint32_t node : scene.order) {
    if (!scene.nodes[node].shown) continue;
    if (const int mesh = file.model.nodes[node].mesh; mesh >= 0) used[static_cast<std::size_t>(mesh)] = true;
  }
  return used;
}

// Materials of those meshes' primitives that are surfaces.
std::vector<bool> materials_in_use(const GltfFile& file, const std::vector<bool>& meshes) {
  std::vector<bool> used(file.model.materials.size(), false);
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    if (!meshes[m]) continue;
    for (const tinygltf::Primitive& primitive : file.model.meshes[m].primitives) {
      if (primitive.material >= 0 && primitive.mode >= TINYGLTF_MODE_TRIANGLES)
        used[static_cast<std::size_t>(primitive.material)] = true;
    }
  }
  return used;
}

// What of the chosen scene breaks the format's rules is refused, and the rest is named.
void require_nodes(const GltfFile& file, const Scene& scene) {
  for (const std::uint32_t index : scene.order) {
    file.require("nodes", index);
    if (scene.nodes[index].light != none) file.require("lights", scene.nodes[index].light);
  }
}

void report_broken(const GltfFile& file) {
  for (const auto& [collection, faults] : file.broken.all()) {
    if (collection == "cameras" || collection == "animations") continue;  // named when they were read
    for (const auto& [index, fault] : faults) file.warn(fault.place, fault.reason + ", but nothing uses it");
  }
}

Scene build_scene(GltfFile& file, const SceneChoice& choice) {
  Scene scene;
  scene.path = file.path;
  scene.variants = variant_names(file);
  choose_variant(file, choice.variant);
  load_cameras(file, scene);
  load_lights(file, scene);
  load_nodes(file, scene);
  select_scene(file, choice.scene, scene);
  hide_nodes(scene);
  report_levels_of_detail(file, scene);
  require_nodes(file, scene);
  const std::vector<bool> used = meshes_in_use(file, scene);
  load_materials(file, materials_in_use(file, used), scene);
  const std::vector<MeshEntry> meshes = load_meshes(file, used, scene);
  bind_meshes(file, meshes, scene);
  load_animations(file, meshes, scene);
  file.bytes->report_unused(file);
  report_broken(file);
  scene.sha256 = file.bytes->sha256();
  scene.warnings = file.warnings.take();
  scene.extensions_read = std::move(file.extensions_read);
  scene.extensions_ignored = std::move(file.extensions_ignored);
  return scene;
}

}  // namespace

Scene load_gltf(const std::string& path, const SceneChoice& choice, const LoadLimits& limits) {
  try {
    GltfFile file = open_gltf(path, limits);
    return build_scene(file, choice);
  } catch (const std::bad_alloc&) {
    throw limit_error(path, "does not fit in memory");
  } catch (const nlohmann::json::exception& error) {
    throw input_error(path, std::string("unexpected JSON: ") + error.what());
  }
}

}  // namespace sheaf
