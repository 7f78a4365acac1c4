// SPDX-License-Identifier: MIT
#include "settings/setting.hpp"

#include <algorithm>

#include "core/error.hpp"
#include "core/quote.hpp"

namespace sheaf {
namespace {

bool holds(const std::vector<Given>& given, std::string_view name) {
  return std::ranges::any_of(given, [&](const Given& one) { return name == one.setting->name; });
}

/// What owns a syntax names the option itself.
std::string complaint(const Given& given, const std::string& reason) {
  if (reason.starts_with("--")) return reason;
  return "--" + std::string(given.setting->name) + " " + quote(given.text) + ": " + reason;
}

}  // namespace

std::vector<Given> with_presets(std::vector<Given> given) {
  std::vector<Given> all;
  for (const Given& one : given) {
    if (one.setting->kind().choices.data() != preset_names().data()) continue;
    for (const Preset& preset : presets()) {
      if (one.text != preset.name) continue;
      for (const PresetValue& value : preset.values)
        if (!holds(given, value.setting)) all.push_back({find_setting(value.setting), value.text});
    }
  }
  std::ranges::move(given, std::back_inserter(all));
  return all;
}

void read_setting(const Given& given, RenderOptions& options) {
  const Setting& setting = *given.setting;
  if (const std::string reason = setting.access.read(given.text, options); !reason.empty())
    throw Error(ErrorKind::usage, complaint(given, reason));
  if (const std::string reason = setting.access.outside(options, setting.range); !reason.empty())
    throw Error(ErrorKind::input, complaint(given, reason));
}

std::optional<Conflict> find_conflict(const RenderOptions& options) {
  if (!options.camera.empty() && !options.camera_node.empty())
    return Conflict{find_setting("camera-node"), "--camera and --camera-node: only one of them can choose the camera"};
  if (std::string reason = compression_conflict(options.compression, options.settings.layers); !reason.empty())
    return Conflict{find_setting("compression"), std::move(reason)};
  return std::nullopt;
}

void read_settings(const std::vector<Given>& given, RenderOptions& options) {
  for (const Given& one : with_presets(given)) read_setting(one, options);
  if (const auto conflict = find_conflict(options)) throw Error(ErrorKind::usage, conflict->reason);
  options.settings.counted =
      options.count == CountPolicy::on ||
      (options.count == CountPolicy::automatic && (!options.stats.empty() || options.settings.layers.tests));
}

nlohmann::ordered_json settings_json(const RenderOptions& options) {
  auto json = nlohmann::ordered_json::object();
  for (const Setting& setting : settings_table()) {
    if (setting.decides != Decides::pixels) continue;
    nlohmann::ordered_json value = setting.access.show(options);
    if (!value.is_null()) json[setting.name] = std::move(value);
  }
  return json;
}

}  // namespace sheaf
