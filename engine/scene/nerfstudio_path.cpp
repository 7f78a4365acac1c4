// SPDX-License-Identifier: MIT
// Nerfstudio's camera_path.json: one camera a frame, evenly spaced, matrices row-major, flat or as
// rows, field of view vertical in degrees, a camera's own or the default for all.
#include <glm/gtc/type_ptr.hpp>
#include <numbers>

#include "core/quote.hpp"
#include "scene/camera_path_json.hpp"

namespace sheaf {
namespace {

double read_fov(const JsonObject& object, const char* key) {
  const double degrees = object.number(key);
  if (!(degrees > 0 && degrees < 180)) object.fail(key, "must be between 0 and 180");
  return degrees * std::numbers::pi / 180;
}

CameraKey read_camera(const JsonObject& camera, double default_fov) {
  CameraKey key;
  const std::vector<double> rows = camera.rows_of_4("camera_to_world");
  pose_from_matrix(camera, "camera_to_world", glm::transpose(glm::make_mat4(rows.data())), key);
  key.fov = camera.has("fov") ? read_fov(camera, "fov") : default_fov;
  if (camera.has("aspect") && !(camera.number("aspect") > 0)) camera.fail("aspect", "must be larger than 0");
  return key;
}

double frames_a_second(const JsonObject& object, const nlohmann::json& document, std::size_t count) {
  if (object.has("fps")) return read_fps(object, document["fps"]);
  if (!object.has("seconds")) return 24;
  const double seconds = object.number("seconds");
  if (!(seconds > 0)) object.fail("seconds", "must be larger than 0");
  return static_cast<double>(count) / seconds;
}

}  // namespace

CameraPath read_nerfstudio_path(const JsonObject& object, const nlohmann::json& document) {
  // The format belongs to another project and grows with it: keys that say nothing about the camera's way are passed
  // over.
  if (object.has("camera_type")) {
    const std::string type = object.text("camera_type");
    if (type != "perspective" && type != "pinhole") {
      object.fail("camera_type", in_quotes(type) + " is not supported, only perspective is");
    }
  }
  CameraPath path;
  const double fov = object.has("default_fov") ? read_fov(object, "default_fov") : CameraKey{}.fov;
  for (const JsonObject& camera : object.objects("camera_path")) path.keys.push_back(read_camera(camera, fov));
  path.fps = frames_a_second(object, document, path.keys.size());
  for (std::size_t i = 0; i < path.keys.size(); ++i) path.keys[i].time = static_cast<double>(i) / *path.fps;
  return path;
}

}  // namespace sheaf
