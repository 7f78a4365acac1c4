// SPDX-License-Identifier: MIT
// File names of frames from `--name PATTERN`: one run of '#' stands for the frame number, zero-padded to the run's
// length, the sign included, as printf's %04d writes it: -12 in #### is -012. A longer number is written whole.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace sheaf {

class FrameNames {
 public:
  /// Throws Error{usage}: no or several runs of '#', a '/' or control character, not ending in .exr, too long.
  explicit FrameNames(const std::string& pattern);

  [[nodiscard]] std::string frame(std::int64_t number) const;    // "name.0012.exr"
  [[nodiscard]] std::string preview(std::int64_t number) const;  // "name.0012.png"
  [[nodiscard]] const std::string& pattern() const { return pattern_; }

 private:
  [[nodiscard]] std::string stem(std::int64_t number) const;

  std::string pattern_, before_, after_;  // after_ without its ".exr"
  std::size_t digits_ = 0;
};

/// "<stem>.####.exr", with a '#' or control character in the scene's stem replaced by '_'.
[[nodiscard]] std::string default_name_pattern(const std::string& scene_path);

}  // namespace sheaf
