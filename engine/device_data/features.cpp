// SPDX-License-Identifier: MIT
#include "device_data/features.hpp"

#include <algorithm>
#include <set>

#include "interface/shared.h"
#include "scene/pose.hpp"

namespace sheaf {
namespace {

// A rasteriser looks at every triangle, a ray at the logarithm. Wall time of whole frames of a city of 1 M triangles on
// a CPU device, drawn against traced: of 1.1 triangles per pixel 0.77, of 4.4 0.87, of 8 0.96, of 17 1.14, of 69 1.86.
constexpr std::uint64_t most_triangles_a_pixel = 8;

struct Roughness {
  float least, most;  // that a material can show anywhere: its factor times the extremes of green of its texture
};

Roughness roughness_of(const Scene& scene, const Material& material) {
  const auto& use = material.metallic_roughness_texture;
  if (!use.present() || scene.textures[use.texture].image == none) return {material.roughness, material.roughness};
  const auto& texels = scene.images[scene.textures[use.texture].image].rgba;
  std::uint8_t least = 255, most = 0;
  for (std::size_t i = 1; i < texels.size(); i += 4) {
    least = std::min(least, texels[i]);
    most = std::max(most, texels[i]);
  }
  return {material.roughness * static_cast<float>(least) / 255.0F,
          material.roughness * static_cast<float>(most) / 255.0F};
}

// At most three by name.
std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < std::min<std::size_t>(names.size(), 3); ++i) text += (i == 0 ? "" : ", ") + names[i];
  return names.size() > 3 ? text + " and " + std::to_string(names.size() - 3) + " more" : text;
}

void add_material(const Scene& scene, std::uint32_t index, const RenderSettings& settings, Features& features) {
  const Material& material = scene.materials[index];
  const Roughness roughness = roughness_of(scene, material);
  const bool lit = !material.unlit;
  features.unlit |= material.unlit;
  const bool transmissive = lit && material.transmission > 0 && !settings.opaque;
  features.transmissive |= transmissive;
  if (transmissive && roughness.most > 0)
    features.rough_glass.push_back(material.name.empty() ? "materials[" + std::to_string(index) + "]"
                                                         : '"' + material.name + '"');
  features.volumes |= lit && material.transmission > 0 && material.thickness > 0 && !settings.opaque;
  features.blended |= material.alpha_mode == AlphaMode::blend && !settings.opaque;
  features.masked |= material.alpha_mode == AlphaMode::mask && !settings.opaque;
  features.reflective |= lit && (roughness.least < 0.4F || transmissive);
  features.one_sided |= hides_back(settings, material);
  features.emissive |= material.emissive != glm::vec3(0);
  features.normal_mapped |= material.normal_texture.present();
  for_each_texture(material, [&](const TextureUse& use, auto...) { features.textured |= use.present(); });
}

}  // namespace

std::vector<std::string> Features::names() const {
  std::vector<std::string> result;
  auto add = [&](bool present, const char* name) {
    if (present) result.emplace_back(name);
  };
  add(default_light, "default light");
  add(lights > 0 && !default_light, "lights");
  add(reflective, "reflective");
  add(transmissive, "transmissive");
  add(!rough_glass.empty(), "rough transmission");
  add(volumes, "volumes");
  add(blended, "alpha blend");
  add(masked, "alpha mask");
  add(textured, "textured");
  add(normal_mapped, "normal maps");
  add(unlit, "unlit");
  add(emissive, "emissive");
  add(one_sided, "single-sided");
  add(coincident, "coincident surfaces");
  add(skinned, "skins");
  add(morphed, "morphs");
  add(moving_nodes, "moving nodes");
  add(moving_camera, "moving camera");
  add(moving_lights, "moving lights");
  return result;
}

bool hides_back(const RenderSettings& settings, const Material& material) {
  return settings.back_faces == BackFaces::hide && !settings.opaque && !material.double_sided &&
         !(material.transmission > 0);
}

Features find_features(const Scene& scene, const std::vector<std::uint32_t>& animations, const RenderSettings& settings,
                       bool camera_moves) {
  Features features;
  features.moving_camera = camera_moves;
  const auto moving = moving_nodes(scene, animations);
  const auto morphing = morphing_nodes(scene, animations);
  std::set<std::uint32_t> used, meshes;
  for (const auto index : scene.order) {
    const Node& node = scene.nodes[index];
    if (node.light != none) {
      ++features.lights;
      features.moving_lights |= moving[index];
    }
    if (node.mesh_count == 0) continue;
    for (std::uint32_t m = 0; m < node.mesh_count; ++m) {
      const Mesh& mesh = scene.meshes[node.first_mesh + m];
      used.insert(mesh.material);
      if (meshes.insert(node.first_mesh + m).second) features.distinct_triangles += mesh.triangles.size();
      features.triangles += mesh.triangles.size() * std::max<std::size_t>(node.instances.size(), 1);
    }
    const bool skinned = node.skin != none;
    if (skinned)
      for (const auto joint : scene.skins[node.skin].joints) features.skinned |= moving[joint];
    features.morphed |= morphing[index];
    features.moving_nodes |= moving[index] && !skinned;
  }
  features.default_light = features.lights == 0;
  if (features.default_light) {
    features.lights = 1;
    features.moving_lights = camera_moves;
  }
  for (const auto material : used) add_material(scene, material, settings, features);
  const SurfaceView view{settings.opaque, settings.back_faces == BackFaces::show};
  features.coincidence = std::make_shared<const Coincidence>(find_coincident(scene, view));
  features.coincident = features.coincidence->any();
  return features;
}

namespace {

// A triangle in world space is 40 bytes. To transform one when it is read gathers 27 words instead of 10: a quarter
// more of a frame's time in a city of ten million copies.
bool transforms_on_fetch(const Features& features, const RenderSettings& settings) {
  constexpr std::uint64_t worth_sharing = std::uint64_t{1} << 23U;
  if (settings.instances != InstancePolicy::automatic) return settings.instances == InstancePolicy::shared;
  return features.triangles - features.distinct_triangles >= worth_sharing &&
         features.triangles >= 2 * features.distinct_triangles;
}

const char* why_backs_show(const RenderSettings& settings) {
  if (settings.opaque) return "--opaque: every surface is two-sided";
  return settings.back_faces == BackFaces::show ? "--back-faces show"
                                                : "every material is double-sided or transmissive";
}

}  // namespace

Plan make_plan(const Features& features, const RenderSettings& settings, Strategy strategy) {
  Plan plan;
  auto leave = [&](const char* stage, const std::string& reason) { plan.left_out.push_back({stage, reason}); };
  plan.coincidence = features.coincidence;
  plan.shadows = true;
  plan.reflections = features.reflective && settings.depth > 0;
  if (!plan.reflections) leave("reflection", settings.depth == 0 ? "--depth 0" : "no reflective material");
  plan.refractions = features.blended || (features.transmissive && settings.depth > 0);
  if (!plan.refractions)
    leave("refraction", features.transmissive ? "--depth 0" : "no transmissive or blended material");
  if (plan.reflections || plan.refractions)
    plan.generations = settings.depth + (features.blended ? gpu::MOST_BLENDED : 0);
  if (!features.rough_glass.empty())
    leave("rough transmission", "drawn clear, only reflection is rough: " + listed(features.rough_glass));
  if (!features.volumes) leave("media", "no volume that refracts and absorbs");
  plan.adaptive = settings.samples.error.has_value();
  const std::uint64_t pixels = std::uint64_t{settings.width} * settings.height;
  const bool crowded = features.triangles > most_triangles_a_pixel * pixels;
  plan.raster =
      (settings.primary == PrimaryMethod::raster || (settings.primary == PrimaryMethod::automatic && !crowded)) &&
      !plan.adaptive;
  if (!plan.raster)
    leave("raster", plan.adaptive ? "--spp adaptive: a rasteriser does not draw single pixels"
                    : settings.primary == PrimaryMethod::trace
                        ? "--primary trace"
                        : "more than eight triangles per pixel: rays are cheaper");
  if (!features.textured) leave("texture filter", "no textures");
  plan.transform_on_fetch = transforms_on_fetch(features, settings);
  if (plan.transform_on_fetch)
    leave("triangles in world space", "most are instances, transformed when read; see --instances");
  plan.deform = features.skinned || features.morphed;
  if (!plan.deform) leave("deform", "nothing is skinned or morphed over time");
  if (!features.geometry_moves()) leave("animate", "nothing moves after the first frame");
  plan.textured_normals = features.normal_mapped;
  if (!features.normal_mapped) leave("normal maps", "no material has one");
  if (!features.masked) leave("alpha test", "no alpha-masked material");
  if (!features.coincident) leave("ranks", "no surfaces lie in one place");
  if (!features.one_sided) leave("back faces", why_backs_show(settings));
  const bool traced = strategy != Strategy::brute && strategy != Strategy::rayquery && strategy != Strategy::reference;
  plan.classes = strategy == Strategy::classify;
  plan.packets = strategy == Strategy::frustum || plan.classes;
  plan.object_hierarchy = strategy == Strategy::bvh || strategy == Strategy::hybrid || plan.packets;
  if (!plan.object_hierarchy)
    leave("object hierarchy", std::string("strategy ") + name_of(strategy) + " does not walk one");
  plan.ray_hierarchy = strategy == Strategy::rsh || strategy == Strategy::crsh;
  plan.bundles = strategy == Strategy::hybrid;
  if (!plan.ray_hierarchy && !plan.packets && !plan.bundles)
    leave("rays_hierarchy", std::string("strategy ") + name_of(strategy) + " has none");
  const bool by_key = strategy == Strategy::crsh || strategy == Strategy::frustum;
  plan.sorts =
      plan.classes || (by_key && settings.sort != SortPolicy::off) || (plan.bundles && settings.sort == SortPolicy::on);
  if (!plan.sorts)
    leave("sort",
          settings.sort == SortPolicy::off && traced ? "--sort off"
          : plan.bundles
              ? "bundles of neighbouring pixels are about as tight, and sorting costs more than it saves; see --sort on"
              : std::string("strategy ") + name_of(strategy) + " does not sort");
  plan.spheres = strategy == Strategy::rsh || strategy == Strategy::crsh;
  return plan;
}

}  // namespace sheaf
