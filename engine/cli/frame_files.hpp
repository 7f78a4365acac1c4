// SPDX-License-Identifier: MIT
// The files of a job's frames: their names, what decides their content, and which of them need not be rendered again.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "frame/camera_source.hpp"
#include "output/frame_inputs.hpp"
#include "output/frame_names.hpp"
#include "settings/render_settings.hpp"

namespace sheaf {

class FrameFiles {
 public:
  /// `options` must outlive it.
  FrameFiles(const RenderOptions& options, const Scene& scene, const std::vector<std::uint32_t>& animations,
             const CameraSource& camera, double fps);

  [[nodiscard]] std::string path_of(std::int64_t number) const;
  [[nodiscard]] std::string preview_of(std::int64_t number) const;
  [[nodiscard]] FrameInputs inputs_of(std::int64_t number) const;
  [[nodiscard]] double seconds(std::int64_t number) const { return static_cast<double>(number) / fps_; }

  /// All, or with --resume those that are not there as they would be rendered now; says which are not and why.
  [[nodiscard]] std::vector<std::int64_t> wanted(Progress& progress) const;

  /// One JSON object per frame, for whoever holds frames that this machine does not see.
  void list_inputs() const;

 private:
  [[nodiscard]] std::filesystem::path folder() const { return static_cast<const std::string&>(options_.out); }
  [[nodiscard]] std::string why_again(std::int64_t number) const;

  const RenderOptions& options_;
  const double fps_;
  const std::vector<std::int64_t> numbers_;
  const FrameNames names_;
  FrameInputs inputs_;  // without number and time
};

}  // namespace sheaf
