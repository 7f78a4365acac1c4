// SPDX-License-Identifier: MIT
// What a scene needs of the engine, found once at load, and the plan that follows: which stages, shader variants and
// buffers there will be, and for each that is left out, why. A stage left out has no pipeline, no memory and no
// dispatch.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "output/stats.hpp"
#include "scene/coincident.hpp"
#include "scene/scene.hpp"
#include "settings/render_settings.hpp"

namespace sheaf {

/// Whether rays other than shadow rays pass through the material's back (glTF 3.9.5).
[[nodiscard]] bool hides_back(const RenderSettings& settings, const Material& material);

struct Features {
  std::uint32_t lights = 0;
  std::uint64_t triangles = 0;           // with all instances
  std::uint64_t distinct_triangles = 0;  // each mesh once
  bool default_light = false;            // the scene has none of its own
  bool reflective = false, transmissive = false, volumes = false, blended = false, masked = false;
  bool textured = false, normal_mapped = false, unlit = false, emissive = false;
  std::vector<std::string> rough_glass;  // materials whose transmission ought to blur what is behind
  bool coincident = false;               // some surfaces lie in one place
  bool one_sided = false;                // some surface's back is passed through
  bool skinned = false, morphed = false, moving_nodes = false, moving_camera = false, moving_lights = false;
  std::shared_ptr<const Coincidence> coincidence;
  [[nodiscard]] bool translucent() const { return transmissive || blended; }
  [[nodiscard]] bool geometry_moves() const { return moving_nodes || skinned || morphed; }
  [[nodiscard]] std::vector<std::string> names() const;
};

/// `camera_moves`: the camera path has several keys, or the camera's node is animated.
[[nodiscard]] Features find_features(const Scene& scene, const std::vector<std::uint32_t>& animations,
                                     const RenderSettings& settings, bool camera_moves);

struct Plan {
  bool shadows = false, reflections = false, refractions = false;
  bool adaptive = false;          // samples are spent pixel by pixel
  std::uint32_t generations = 0;  // of rays after the camera's, at most
  bool raster = true, deform = false, textured_normals = false;
  bool sorts = false, ray_hierarchy = false, object_hierarchy = false, bundles = false, packets = false,
       spheres = false;
  bool classes = false;  // rays are sorted by class, also camera rays
  /// Triangles are transformed by their instances when read, and not kept in world space.
  bool transform_on_fetch = false;
  std::shared_ptr<const Coincidence> coincidence;  // the scene's
  std::vector<LeftOut> left_out;
};

[[nodiscard]] Plan make_plan(const Features& features, const RenderSettings& settings, Strategy strategy);

}  // namespace sheaf
