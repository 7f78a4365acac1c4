// SPDX-License-Identifier: MIT
// Camera path files: our own format. Errors say where: "path.json: keys[2].rotation: has no length".
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <glm/gtc/type_ptr.hpp>
#include <numbers>
#include <sstream>

#include "core/error.hpp"
#include "scene/camera_path.hpp"
#include "scene/camera_path_json.hpp"
#include "scene/gltf_container.hpp"
#include "scene/rigid.hpp"

namespace sheaf {
namespace {

constexpr std::uintmax_t max_bytes = 256u << 20;

void read_look_at(const JsonObject& key, CameraKey& out) {
  out.position = key.vec3("eye");
  const glm::dvec3 back = out.position - key.vec3("target");
  const glm::dvec3 up = key.has("up") ? key.vec3("up") : glm::dvec3(0, 1, 0);
  const double distance = glm::length(back), length = glm::length(up);
  if (!(distance > 0) || !std::isfinite(distance)) key.fail("target", "is at the eye");
  if (!(length > 0) || !std::isfinite(length)) key.fail("up", "has no length");
  const glm::dvec3 z = back / distance;
  const glm::dvec3 x = glm::cross(up / length, z);
  if (glm::length(x) < 1e-9) key.fail("up", "is parallel to the view");
  const glm::dvec3 right = glm::normalize(x);
  out.rotation = unit_or_identity(glm::quat_cast(glm::dmat3(right, glm::cross(z, right), z)));
}

void read_position_rotation(const JsonObject& key, CameraKey& out) {
  out.position = key.vec3("position");
  const std::vector<double> r = key.numbers("rotation", 4);
  const glm::dquat q(r[3], r[0], r[1], r[2]);
  const double length = glm::length(q);
  if (!(length > 1e-6) || !std::isfinite(length)) key.fail("rotation", "has no length");
  out.rotation = q / length;
}

void read_pose(const JsonObject& key, CameraKey& out) {
  const bool placed = key.has("position") || key.has("rotation");
  const bool looking = key.has("eye") || key.has("target") || key.has("up");
  const bool matrix = key.has("matrix");
  if (placed + looking + matrix != 1) {
    key.fail("", "needs one of position and rotation; eye, target and up; matrix");
  }
  if (placed) return read_position_rotation(key, out);
  if (looking) return read_look_at(key, out);
  pose_from_matrix(key, "matrix", glm::make_mat4(key.numbers("matrix", 16).data()), out);
}

double positive(const JsonObject& key, const char* name) {
  const double value = key.number(name);
  if (!(value > 0)) key.fail(name, "must be larger than 0");
  return value;
}

void read_lens(const JsonObject& key, bool horizontal, CameraKey& out) {
  const bool focal = key.has("focal_mm") || key.has("sensor_mm");
  if (key.has("fov_degrees") + focal + key.has("ortho_height") > 1) {
    key.fail("", "has more than one of fov_degrees, focal_mm and ortho_height");
  }
  if (key.has("fov_degrees")) {
    const double degrees = key.number("fov_degrees");
    if (!(degrees > 0 && degrees < 180)) key.fail("fov_degrees", "must be between 0 and 180");
    out.fov = degrees * std::numbers::pi / 180;
  } else if (focal) {
    const double length = positive(key, "focal_mm");
    const std::vector<double> sensor = key.has("sensor_mm") ? key.numbers("sensor_mm", 2) : std::vector<double>{36, 24};
    if (!(sensor[0] > 0 && sensor[1] > 0)) key.fail("sensor_mm", "must be larger than 0");
    out.fov = 2 * std::atan(sensor[horizontal ? 0 : 1] / (2 * length));
    if (!(out.fov > 0 && out.fov < std::numbers::pi)) key.fail("focal_mm", "gives no usable field of view");
  } else if (key.has("ortho_height")) {
    out.orthographic = true;
    out.ortho_height = positive(key, "ortho_height");
  }
  out.near = key.number_or("near", out.near);
  out.far = key.number_or("far", out.far);
  if (!(out.near >= 0)) key.fail("near", "must not be negative");
  if (!(out.far > out.near)) key.fail("far", "must be larger than near");
}

CameraKey read_key(const JsonObject& key, bool horizontal) {
  key.only({"time", "position", "rotation", "eye", "target", "up", "matrix", "fov_degrees", "focal_mm", "sensor_mm",
            "ortho_height", "near", "far"});
  CameraKey out;
  out.time = key.number("time");
  read_pose(key, out);
  read_lens(key, horizontal, out);
  return out;
}

std::string choice(const JsonObject& object, const char* key, std::initializer_list<const char*> choices) {
  if (!object.has(key)) return *choices.begin();
  const std::string value = object.text(key);
  std::string names;
  for (const char* name : choices) {
    if (value == name) return value;
    names += (names.empty() ? "" : ", ") + std::string(name);
  }
  object.fail(key, in_quotes(value) + " is not one of " + names);
}

CameraPath read_path(const JsonObject& object, const nlohmann::json& document) {
  object.only({"version", "fps", "interpolation", "loop", "fov_axis", "keys"});
  if (object.has("version") && object.number("version") != 1) object.fail("version", "only version 1 is supported");
  CameraPath path;
  if (object.has("fps")) path.fps = read_fps(object, document["fps"]);
  const std::string mode = choice(object, "interpolation", {"linear", "step", "catmull-rom"});
  path.interpolation = mode == "step"     ? PathInterpolation::step
                       : mode == "linear" ? PathInterpolation::linear
                                          : PathInterpolation::catmull_rom;
  path.loop = object.boolean_or("loop", false);
  path.fov_horizontal = choice(object, "fov_axis", {"vertical", "horizontal"}) == "horizontal";
  for (const JsonObject& key : object.objects("keys")) {
    path.keys.push_back(read_key(key, path.fov_horizontal));
    const std::size_t count = path.keys.size();
    if (count > 1 && !(path.keys[count - 1].time > path.keys[count - 2].time)) {
      key.fail("time", "is not later than the key before it");
    }
  }
  return path;
}

}  // namespace

CameraPath parse_camera_path(const std::string& json_text, const std::string& name_for_errors) {
  const nlohmann::json document = parse_json(json_text, name_for_errors);
  const JsonObject object(document, name_for_errors, "");
  const bool foreign = object.has("camera_path");
  CameraPath path = foreign ? read_nerfstudio_path(object, document) : read_path(object, document);
  if (const auto key = first_unsound_key(path))
    object.fail((foreign ? "camera_path[" : "keys[") + std::to_string(*key) + "]",
                "the camera moves too far or too fast to the next one for double precision");
  return path;
}

CameraPath load_camera_path(const std::string& path) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) throw io_error(path, error.message());
  if (size > max_bytes) throw limit_error(path, "is larger than 256 MiB");
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream || !text) throw io_error(path, std::strerror(errno));
  return parse_camera_path(text.str(), path);
}

}  // namespace sheaf
