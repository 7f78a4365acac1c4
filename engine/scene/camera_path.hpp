// SPDX-License-Identifier: MIT
// Camera paths (`--camera`): our own format, version 1, and Nerfstudio's camera_path.json, read as it is.
#pragma once

#include <glm/glm.hpp>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace sheaf {

/// A camera at one moment. Looks along -Z of `to_world`, +Y up; right-handed.
struct CameraView {
  glm::dmat4 to_world{1};  // rigid: rotation and translation only
  bool orthographic = false;
  double tan_half_y = 0.41421356237309503;  // perspective: tangent of half the vertical field of view
  double half_height = 1;                   // orthographic
  double near = 0, far = std::numeric_limits<double>::infinity();  // along the view axis; near 0: nothing is cut
};

enum class PathInterpolation { step, linear, catmull_rom };

struct CameraKey {
  double time = 0;
  glm::dvec3 position{0};
  glm::dquat rotation{1, 0, 0, 0};
  bool orthographic = false;
  double fov = 0.7853981633974483;  // radians, along the path's fov_axis; used where !orthographic
  double ortho_height = 2;
  double near = 0, far = std::numeric_limits<double>::infinity();
};

struct CameraPath {
  std::optional<double> fps;
  PathInterpolation interpolation = PathInterpolation::linear;
  bool loop = false;
  bool fov_horizontal = false;
  std::vector<CameraKey> keys;  // strictly increasing times, at least one
};

/// Throws Error{input} with the file, the JSON place ("keys[2].rotation") and the reason. Unknown keys are refused by
/// name.
[[nodiscard]] CameraPath load_camera_path(const std::string& path);
[[nodiscard]] CameraPath parse_camera_path(const std::string& json_text, const std::string& name_for_errors);

/// The first key from which the motion to the next one cannot be followed in doubles; nothing for a sound path.
[[nodiscard]] std::optional<std::size_t> first_unsound_key(const CameraPath& path);

/// `path` is sound. `aspect` is width / height of the image (needed where fov_axis is horizontal).
[[nodiscard]] CameraView evaluate_camera_path(const CameraPath& path, double time_s, double aspect);

/// A scene camera under its node's world matrix. Scale in the node is dropped (rigid part by polar-like
/// orthonormalisation). The vertical field of view is kept whatever the image's aspect.
[[nodiscard]] CameraView view_of(const Camera& camera, const glm::dmat4& node_to_world, double aspect);

/// Frames the whole box [lo, hi]: 45° vertical field of view, seen from +Z a little from above and the right, from as
/// near as leaves 5 % of the picture's width and height free on each side of the corners. An empty or point-sized box
/// is framed as a cube of 1 m.
[[nodiscard]] CameraView framing_view(const glm::dvec3& lo, const glm::dvec3& hi, double aspect);

}  // namespace sheaf
