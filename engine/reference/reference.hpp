// SPDX-License-Identifier: MIT
// Renders a frame on the CPU in double precision, as SHADING.md says: the picture that errors are measured against.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "sampling/pixel_samples.hpp"
#include "scene/camera_path.hpp"
#include "scene/coincident.hpp"
#include "scene/pose.hpp"
#include "scene/scene.hpp"

namespace sheaf {

struct ReferenceTriangle {
  glm::dvec3 v[3];         // world space relative to the frame origin
  std::uint32_t instance;  // numbered by node in scene order, its instances, its meshes
  std::uint32_t mesh, triangle_in_mesh;
};

struct ReferenceSettings {
  std::uint32_t width = 640, height = 360, spp = 1;  // spp: where samples are adaptive, the most
  std::optional<double> adaptive_error;              // see AdaptivePixels
  PixelFilter filter = PixelFilter::gaussian;
  std::uint32_t depth = 4;                // bounces of a ray
  double cutoff = 0.002;                  // weights below make no further rays
  bool opaque = false;                    // every surface opaque: no alpha, no transmission
  bool transparent_glass = false;         // what is seen through transmission is not covered
  bool show_backs = false;                // of single-sided surfaces, to camera, reflection and refraction rays
  std::optional<glm::dvec3> environment;  // else 0.4 where the scene has no light, 0 where it has
  std::shared_ptr<const Coincidence> coincidence;  // null: found by render_reference
  std::uint32_t threads = 0;                       // 0: as many as the machine has; the picture does not depend on it
  std::function<bool()> stop;  // asked between rows, by any thread: true ends it with Error{interrupted}
};

struct ReferenceCounts {  // by kind: primary, shadow, reflection, refraction
  std::array<std::uint64_t, 4> rays{}, hits{}, box_tests{}, triangle_tests{};
  std::uint64_t stopped = 0;  // rays that went through as many blended surfaces as a ray may
};

/// Pixels row by row from the top. Layers hold what the ray through a pixel's centre meets first; a miss: depth +inf,
/// triangle `none`, else 0.
struct ReferenceFrame {
  std::uint32_t width = 0, height = 0;
  glm::dvec3 origin{0};              // of the triangles: the camera's position
  std::vector<glm::vec4> rgba;       // linear, premultiplied
  std::vector<float> depth;          // along the view axis
  std::vector<glm::vec3> normal;     // shading normal, towards the camera
  std::vector<glm::dvec3> position;  // absolute
  std::vector<glm::vec3> albedo;
  std::vector<glm::vec2> uv;
  std::vector<std::uint32_t> object, material;  // node + 1, material + 1
  std::vector<std::uint32_t> triangle;          // as reference_triangles() numbers them
  std::uint64_t triangles = 0;
  ReferenceCounts counts;
};

/// The scene's triangles under a pose, in the order of their ids.
[[nodiscard]] std::vector<ReferenceTriangle> reference_triangles(const Scene& scene, const Pose& pose,
                                                                 const glm::dvec3& origin);

/// Throws Error{input} for settings outside their range, Error{limit} past 2^27 triangles.
[[nodiscard]] ReferenceFrame render_reference(const Scene& scene, const Pose& pose, const CameraView& view,
                                              const ReferenceSettings& settings);

}  // namespace sheaf
