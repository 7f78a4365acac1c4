// SPDX-License-Identifier: MIT
#include "cli/frame_files.hpp"

#include <cstdio>
#include <map>

#include "output/exr_writer.hpp"
#include "output/frame_range.hpp"
#include "settings/setting.hpp"

namespace sheaf {
namespace {

namespace fs = std::filesystem;

/// The settings that decide pixels, and of the rest what frames differ by.
nlohmann::ordered_json decisive_settings(const RenderOptions& options, const std::vector<std::uint32_t>& animations,
                                         const CameraSource& camera, double fps) {
  auto settings = settings_json(options);
  settings["fps"] = fps;
  if (const std::string& name = options.scene_name; !name.empty()) settings["scene-name"] = name;
  if (const std::string& name = options.variant; !name.empty()) settings["variant"] = name;
  settings["animation"] = animations;
  settings["camera"] = camera.identity();
  for (const char* name : {"aov", "compression"}) settings[name] = find_setting(name)->access.show(options);
  // It decides what is counted.
  if (options.settings.layers.tests) settings["strategy"] = find_setting("strategy")->access.show(options);
  return settings;
}

}  // namespace

FrameFiles::FrameFiles(const RenderOptions& options, const Scene& scene, const std::vector<std::uint32_t>& animations,
                       const CameraSource& camera, double fps)
    : options_(options),
      fps_(fps),
      numbers_(parse_frames(options.frames)),
      names_(options.name.empty() ? default_name_pattern(options.scene) : std::string(options.name)),
      inputs_{SHEAF_VERSION, scene.sha256, decisive_settings(options, animations, camera, fps).dump(), 0, 0} {}

std::string FrameFiles::path_of(std::int64_t number) const { return (folder() / names_.frame(number)).string(); }

std::string FrameFiles::preview_of(std::int64_t number) const { return (folder() / names_.preview(number)).string(); }

FrameInputs FrameFiles::inputs_of(std::int64_t number) const {
  FrameInputs inputs = inputs_;
  inputs.frame = number;
  inputs.time_s = seconds(number);
  return inputs;
}

// Why a frame that is there has to be rendered again; empty where it need not.
std::string FrameFiles::why_again(std::int64_t number) const {
  const std::string path = path_of(number);
  const auto there = read_frame_inputs(path);
  if (!there) return "not whole, or not of this program";
  const std::string different = difference(*there, inputs_of(number));
  if (!different.empty()) return different;
  if (!exr_is_whole(path, options_.settings.width, options_.settings.height)) return "not whole";
  if (options_.preview && !fs::is_regular_file(preview_of(number))) return "no preview";
  return {};
}

std::vector<std::int64_t> FrameFiles::wanted(Progress& progress) const {
  if (!options_.resume) return numbers_;
  std::vector<std::int64_t> wanted;
  std::map<std::string, std::size_t> reasons;
  std::size_t again = 0;
  for (const auto number : numbers_) {
    const bool there = fs::exists(path_of(number));
    const std::string reason = there ? why_again(number) : "";
    if (there && reason.empty()) continue;
    wanted.push_back(number);
    if (!there) continue;
    ++again;
    ++reasons[reason];
  }
  std::string text;
  for (const auto& [reason, count] : reasons)
    text += (text.empty() ? "" : "; ") + reason + (reasons.size() > 1 ? " (" + std::to_string(count) + ")" : "");
  if (again > 0)
    progress.warning("--resume: " + std::to_string(again) + (again == 1 ? " frame that is" : " frames that are") +
                     " there will be rendered again: " + text);
  return wanted;
}

void FrameFiles::list_inputs() const {
  for (const auto number : numbers_) {
    auto line = to_json(inputs_of(number));
    line["file"] = names_.frame(number);
    std::printf("%s\n", line.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace).c_str());
  }
}

}  // namespace sheaf
