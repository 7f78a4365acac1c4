// SPDX-License-Identifier: MIT
// The command line of `sheaf render`, parsed and checked.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "frame/settings.hpp"
#include "output/exr_writer.hpp"
#include "output/progress.hpp"

namespace CLI {
class App;
}

namespace sheaf {

struct RenderOptions {
  std::string scene, out;
  std::string camera, camera_node, scene_name;
  std::string frames = "0";
  std::string fps_text;
  std::optional<double> fps;
  std::string animation;
  std::string size = "1280x720", filter = "gaussian";
  std::string quality;
  std::optional<std::string> spp;
  std::string strategy = "auto", sort = "auto", primary = "auto", instances = "auto", layers, compression = "zip", name,
              environment, z_background = "1e10", glass_alpha = "opaque";
  std::string stats, dump, device, progress = "auto", count = "auto";
  std::optional<std::uint32_t> depth;
  std::optional<float> cutoff;
  RenderSettings settings;
  bool resume = false, preview = false;
};

/// Adds the options of `sheaf render` to a subcommand; values land in `options` when the line is parsed.
void add_render_options(CLI::App& command, RenderOptions& options);

/// Turns the texts into settings. Throws Error{usage} or Error{input} naming the option and the reason.
void resolve_options(RenderOptions& options);

}  // namespace sheaf
