// SPDX-License-Identifier: MIT
#include "frame/camera_source.hpp"

#include <charconv>
#include <initializer_list>
#include <sstream>

#include "core/error.hpp"
#include "core/quote.hpp"
#include "core/sha256.hpp"
#include "frame/scene_bounds.hpp"

namespace sheaf {
namespace {

std::uint32_t find_camera_node(const Scene& scene, const std::string& selector) {
  std::vector<std::uint32_t> nodes;
  for (const auto index : scene.order)
    if (scene.nodes[index].camera != none) nodes.push_back(index);
  if (selector.empty()) return nodes.empty() ? none : nodes.front();
  for (const auto index : nodes)
    if (scene.nodes[index].name == selector || scene.cameras[scene.nodes[index].camera].name == selector) return index;
  std::size_t wanted = 0;
  const char* end = selector.data() + selector.size();
  if (std::from_chars(selector.data(), end, wanted).ptr == end && wanted < nodes.size()) return nodes[wanted];
  std::vector<std::string> names;
  for (const auto index : nodes) names.push_back(scene.nodes[index].name);
  const std::string known = quoted_list(names);
  throw input_error(scene.path, "--camera-node " + quote(selector) + ": the scene has " + std::to_string(nodes.size()) +
                                    " cameras" + (known.empty() ? "" : " (" + known + ")"));
}

}  // namespace

CameraSource::CameraSource(const Scene& scene, const std::vector<std::uint32_t>& animations,
                           const std::string& path_file, const std::string& node_selector, double aspect)
    : scene_(scene), aspect_(aspect) {
  if (!path_file.empty()) {
    path_ = load_camera_path(path_file);
    moves_ = path_->keys.size() > 1;
    description_ = "path " + path_file;
    return;
  }
  node_ = find_camera_node(scene, node_selector);
  if (node_ != none) {
    const std::string& fault = scene.cameras[scene.nodes[node_].camera].fault;
    if (!fault.empty()) throw Error(ErrorKind::input, fault);
    moves_ = moving_nodes(scene, animations)[node_];
    description_ = "camera of node " + std::to_string(node_) + " (" + scene.nodes[node_].name + ")";
    return;
  }
  const WorldBox box = animated_bounds(scene, animations);
  framed_ = framing_view(box.empty() ? glm::dvec3(0) : box.lo, box.empty() ? glm::dvec3(0) : box.hi, aspect);
  description_ = "the scene framed whole";
}

std::string CameraSource::identity() const {
  std::ostringstream text;
  text.precision(17);
  const auto numbers = [&](std::initializer_list<double> values) {
    for (const double value : values) text << value << ' ';
  };
  if (node_ != none) return "node " + std::to_string(node_);
  if (!path_) {  // its place may hang on the last bit of a sine: floats tell enough
    text.precision(7);
    const glm::dvec3 eye = framed_.to_world[3], back = framed_.to_world[2];
    numbers({eye.x, eye.y, eye.z, back.x, back.y, back.z, framed_.tan_half_y});
    return "framed " + text.str();
  }
  numbers({static_cast<double>(path_->interpolation), path_->loop ? 1.0 : 0.0, path_->fov_horizontal ? 1.0 : 0.0});
  for (const CameraKey& k : path_->keys)
    numbers({k.time, k.position.x, k.position.y, k.position.z, k.rotation.x, k.rotation.y, k.rotation.z, k.rotation.w,
             k.orthographic ? k.ortho_height : k.fov, k.orthographic ? 1.0 : 0.0, k.near, k.far});
  const std::string all = text.str();
  return "path " + sha256_of(all);
}

CameraView CameraSource::at(const Pose& pose, double time_s) const {
  if (path_) return evaluate_camera_path(*path_, time_s, aspect_);
  if (node_ != none) return view_of(scene_.cameras[scene_.nodes[node_].camera], pose.world[node_], aspect_);
  return framed_;
}

}  // namespace sheaf
