// SPDX-License-Identifier: MIT
#include <cstdio>
#include <nlohmann/json.hpp>

#include "cli/commands.hpp"
#include "device_data/features.hpp"
#include "frame/camera_source.hpp"
#include "scene/gltf_loader.hpp"
#include "scene/pose.hpp"

namespace sheaf {
namespace {

using Json = nlohmann::ordered_json;

Json named(const std::string& name, Json more) {
  Json item{{"name", name}};
  item.update(more);
  return item;
}

Json describe(const Scene& scene) {
  std::uint64_t unique = 0, total = 0, instances = 0, texture_bytes = 0;
  for (const auto& mesh : scene.meshes) unique += mesh.triangles.size();
  for (const auto& image : scene.images) texture_bytes += image.rgba.size();
  auto cameras = Json::array(), lights = Json::array(), animations = Json::array();
  for (const auto index : scene.order) {
    const Node& node = scene.nodes[index];
    const std::uint64_t copies = node.instances.empty() ? 1 : node.instances.size();
    for (std::uint32_t m = 0; m < node.mesh_count; ++m) {
      total += copies * scene.meshes[node.first_mesh + m].triangles.size();
      instances += copies;
    }
    if (node.camera != none)
      cameras.push_back(
          named(node.name,
                {{"node", index}, {"kind", scene.cameras[node.camera].orthographic ? "orthographic" : "perspective"}}));
    if (node.light != none) {
      constexpr const char* kinds[] = {"directional", "point", "spot"};
      lights.push_back(
          named(node.name, {{"node", index}, {"kind", kinds[static_cast<int>(scene.lights[node.light].kind)]}}));
    }
  }
  for (const auto& animation : scene.animations)
    animations.push_back(
        named(animation.name, {{"seconds", animation.duration}, {"channels", animation.channels.size()}}));
  return {{"scene", scene.path},
          {"sha256", scene.sha256},
          {"triangles", total},
          {"unique_triangles", unique},
          {"instances", instances},
          {"meshes", scene.meshes.size()},
          {"materials", scene.materials.size()},
          {"images", scene.images.size()},
          {"texture_bytes", texture_bytes},
          {"nodes", scene.order.size()},
          {"skins", scene.skins.size()},
          {"cameras", cameras},
          {"lights", lights},
          {"animations", animations},
          {"variants", scene.variants},
          {"extensions_read", scene.extensions_read},
          {"extensions_ignored", scene.extensions_ignored},
          {"warnings", scene.warnings}};
}

void print_list(const char* title, const Json& list) {
  if (list.empty()) return;
  std::printf("%s\n", title);
  for (const auto& item : list) {
    if (item.is_string()) {
      std::printf("  %s\n", item.get<std::string>().c_str());
      continue;
    }
    std::string line;
    for (const auto& [key, value] : item.items())
      line += (line.empty() ? "" : ", ") + (key == "name" ? "" : key + " ") +
              (value.is_string() ? value.get<std::string>() : value.dump());
    std::printf("  %s\n", line.c_str());
  }
}

}  // namespace

int run_inspect(const std::string& path, const std::string& scene_name, const std::string& variant, bool json) {
  const Scene scene = load_gltf(path, {scene_name, variant});
  const auto animations = select_animations(scene, {});
  const CameraSource camera(scene, animations, {}, {}, 16.0 / 9.0);
  RenderSettings settings;
  const Features features = find_features(scene, animations, settings, camera.moves());
  const Plan plan = make_plan(features, settings, Strategy::hybrid);
  Json all = describe(scene);
  all["camera"] = camera.description();
  all["features"] = features.names();
  all["left_out"] = Json::array();
  for (const auto& item : plan.left_out) all["left_out"].push_back({{"stage", item.stage}, {"reason", item.reason}});
  if (json) {
    std::printf("%s\n", all.dump(2, ' ', false, Json::error_handler_t::replace).c_str());
    return 0;
  }
  std::printf("%s\n", path.c_str());
  for (const char* key :
       {"triangles", "unique_triangles", "instances", "meshes", "materials", "images", "nodes", "skins"})
    std::printf("  %-17s %s\n", key, all[key].dump().c_str());
  std::printf("looks through\n  %s\n", camera.description().c_str());
  print_list("cameras", all["cameras"]);
  print_list("lights", all["lights"]);
  print_list("animations", all["animations"]);
  print_list("variants", all["variants"]);
  print_list("needs", all["features"]);
  print_list("left out", all["left_out"]);
  print_list("extensions", all["extensions_read"]);
  print_list("ignored extensions", all["extensions_ignored"]);
  print_list("warnings", all["warnings"]);
  return 0;
}

}  // namespace sheaf
