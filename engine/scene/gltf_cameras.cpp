// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <numbers>

#include "scene/gltf_nodes.hpp"

namespace sheaf {
namespace {

using nlohmann::json;

Camera perspective_camera(const GltfFile& file, const json& object, const std::string& place) {
  Camera camera;
  camera.yfov = object.at("yfov").get<double>();
  camera.aspect = number_or(object, "aspectRatio", 0);
  camera.near = object.at("znear").get<double>();
  const double far = number_or(object, "zfar", 0);
  if (far > 0) {
    camera.far = far;
  } else if (object.contains("zfar")) {
    file.warn(place + ".zfar", "is 0, taken as infinite");
  }
  if (!(camera.yfov > 0 && camera.yfov < std::numbers::pi)) file.fail(place + ".yfov", "must be between 0 and pi");
  if (!(camera.near >= 0 && camera.far > camera.near)) file.fail(place, "zfar must be larger than znear");
  return camera;
}

Camera orthographic_camera(const GltfFile& file, const json& object, const std::string& place) {
  Camera camera;
  camera.orthographic = true;
  // Some exporters write negative magnifications; their size is what counts.
  camera.xmag = std::abs(object.at("xmag").get<double>());
  camera.ymag = std::abs(object.at("ymag").get<double>());
  camera.near = object.at("znear").get<double>();
  camera.far = object.at("zfar").get<double>();
  if (camera.xmag == 0 || camera.ymag == 0) file.fail(place, "xmag and ymag must not be 0");
  if (!(camera.far > camera.near)) file.fail(place, "zfar must be larger than znear");
  return camera;
}

void read_spot(GltfFile& file, const json& object, const std::string& place, Light& light) {
  const json* spot = member(object, "spot");
  if (!spot) file.fail(place + ".spot", "is missing");
  double inner = number_or(*spot, "innerConeAngle", 0);
  double outer = number_or(*spot, "outerConeAngle", std::numbers::pi / 4);
  if (!(outer > 0 && outer <= std::numbers::pi / 2 + 1e-6))
    file.fail(place + ".spot.outerConeAngle", "must be between 0 and pi / 2");
  if (inner < 0 || inner >= outer) {
    // An inner cone as wide as the outer one is a hard edge: the falloff between them must keep a width.
    const double inside = std::clamp(inner, 0.0, outer * (1 - 1e-4));
    if (inner != outer) file.warn(place + ".spot.innerConeAngle", "is not between 0 and outerConeAngle");
    inner = inside;
  }
  light.inner_cone = static_cast<float>(inner);
  light.outer_cone = static_cast<float>(outer);
}

Light read_light(GltfFile& file, const json& object, const std::string& place) {
  Light light;
  light.name = object.value("name", "");
  const std::string type = object.at("type").get<std::string>();
  if (type == "directional") {
    light.kind = LightKind::directional;
  } else if (type == "spot") {
    light.kind = LightKind::spot;
    read_spot(file, object, place, light);
  } else if (type != "point") {
    file.fail(place + ".type", in_quotes(type) + " is not directional, point or spot");
  }
  if (const json* color = member(object, "color")) {
    for (int c = 0; c < 3; ++c) light.color[c] = (*color)[static_cast<std::size_t>(c)].get<float>();
  }
  light.intensity = static_cast<float>(number_or(object, "intensity", 1));
  if (object.contains("range")) {
    light.range = static_cast<float>(number_or(object, "range", 0));
    if (light.range == 0) {
      file.warn(place + ".range", "is 0, taken as infinite");
      light.range = std::numeric_limits<float>::infinity();
    }
  }
  return light;
}

}  // namespace

void load_cameras(GltfFile& file, Scene& scene) {
  for (std::size_t i = 0; i < file.count("cameras"); ++i) {
    const json& object = file.json["cameras"][i];
    Camera& camera = scene.cameras.emplace_back();
    try {
      file.require("cameras", i);
      const std::string type = object.at("type").get<std::string>(), place = at("cameras", i) + "." + type;
      camera = (type == "perspective" ? &perspective_camera : &orthographic_camera)(file, object.at(type), place);
    } catch (const Error& error) {
      camera.fault = error.what();
      file.warn_of(camera.fault, "the camera cannot be used");
    }
    camera.name = object.value("name", "");
  }
}

void load_lights(GltfFile& file, Scene& scene) {
  const json* list = extension(file.json, "KHR_lights_punctual");
  list = list ? member(*list, "lights") : nullptr;
  if (!list) return;
  for (std::size_t i = 0; i < list->size(); ++i) {
    Light& light = scene.lights.emplace_back();
    const std::string place = "extensions.KHR_lights_punctual." + at("lights", i);
    if (file.broken.find("lights", i)) continue;
    try {
      light = read_light(file, (*list)[i], place);
    } catch (const Error& error) {
      file.broken.mark("lights", i, file.fault_of(error.what()));
    }
  }
}

}  // namespace sheaf
