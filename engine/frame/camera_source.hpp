// SPDX-License-Identifier: MIT
// Which camera a run looks through, and where it is at any time.
#pragma once

#include <optional>
#include <string>

#include "scene/camera_path.hpp"
#include "scene/pose.hpp"
#include "scene/scene.hpp"

namespace sheaf {

class CameraSource {
 public:
  /// `path_file`, else `node_selector` (camera's or its node's name, or an index among the scene's cameras), else the
  /// scene's first camera, else the scene framed whole. Throws Error{input}.
  CameraSource(const Scene& scene, const std::vector<std::uint32_t>& animations, const std::string& path_file,
               const std::string& node_selector, double aspect);

  [[nodiscard]] CameraView at(const Pose& pose, double time_s) const;
  [[nodiscard]] bool moves() const { return moves_; }
  [[nodiscard]] std::optional<double> fps() const { return path_ ? path_->fps : std::nullopt; }
  [[nodiscard]] const std::string& description() const { return description_; }
  /// The same for cameras that give the same views of a scene: of a path its numbers count, not its file's name.
  [[nodiscard]] std::string identity() const;

 private:
  const Scene& scene_;
  std::optional<CameraPath> path_;
  std::uint32_t node_ = none;
  CameraView framed_;
  double aspect_ = 1;
  bool moves_ = false;
  std::string description_;
};

}  // namespace sheaf
