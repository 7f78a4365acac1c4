// SPDX-License-Identifier: MIT
#include "jobs/settings.hpp"

#include <algorithm>

#include "core/quote.hpp"
#include "output/frame_range.hpp"
#include "settings/setting_json.hpp"
#include "util/problem.hpp"

namespace sheaf::server {
namespace {

using nlohmann::json;

[[noreturn]] void refuse(std::string_view key, const std::string& reason) {
  throw Problem(ProblemKind::bad_settings, "settings." + quote(key) + ": " + reason).at(key);
}

void refuse_unknown(const json& given) {
  for (const auto& [key, value] : given.items()) {
    const Setting* const setting = find_setting(key);
    if (setting == nullptr) refuse(key, "there is no such setting");
    if (setting->part != nullptr)
      refuse(key, "not accepted over HTTP as a setting; it is the part '" + std::string(setting->part) + "'");
    if (!setting->http) refuse(key, "not accepted over HTTP");
  }
}

/// `key` is what the client wrote: a preset stands for settings that it did not.
void check_limit(const Given& given, const RenderOptions& options, const Limits& limits, const char* key) {
  const SettingLimit* const limit = find_limit(given.setting->limit);
  if (limit == nullptr) return;
  const std::uint64_t value = given.setting->access.amount(options), most = limits.*limit->value;
  if (value > most)
    throw Problem(ProblemKind::limit_exceeded, "settings." + std::string(key) + ": " + std::to_string(value) + " " +
                                                   limit->of + ", the limit is " + std::to_string(most))
        .at(key)
        .exceeded(limit->name, most, value);
}

std::vector<Given> given_in(const json& settings) {
  std::vector<Given> all;
  for (const Setting& setting : settings_table()) {
    if (!setting.http) continue;
    Given given{&setting, setting.service != nullptr ? setting.service : ""};
    if (settings.contains(setting.name)) {
      if (const std::string reason = text_from_json(setting, settings[setting.name], given.text); !reason.empty())
        refuse(setting.name, reason);
    } else if (setting.service == nullptr) {
      continue;
    }
    all.push_back(std::move(given));
  }
  return all;
}

/// The values, each held against the service's limits and its range.
RenderOptions checked(const std::vector<Given>& given, const json& settings, const Limits& limits) {
  RenderOptions options;
  for (const Given& one : with_presets(given)) {
    const char* const key = settings.contains(one.setting->name) ? one.setting->name : "quality";
    if (const std::string reason = one.setting->access.read(one.text, options); !reason.empty()) refuse(key, reason);
    check_limit(one, options, limits, key);
    const std::string reason = one.setting->access.outside(options, one.setting->range);
    if (!reason.empty()) refuse(key, reason);
  }
  if (options.name.starts_with('.')) refuse("name", "must not start with a dot");
  if (const auto conflict = find_conflict(options)) refuse(conflict->setting->name, conflict->reason);
  return options;
}

std::string argument_of(const Given& given) {
  const std::string option = "--" + std::string(given.setting->name);
  return given.setting->is_flag() ? option : option + "=" + given.text;
}

}  // namespace

Settings parse_settings(const json& given, bool has_camera, const Limits& limits) {
  if (!given.is_object()) throw Problem(ProblemKind::bad_settings, "settings: must be a JSON object");
  refuse_unknown(given);
  if (has_camera && given.contains("camera-node")) refuse("camera-node", "a camera part was uploaded as well");

  const std::vector<Given> values = given_in(given);
  const RenderOptions options = checked(values, given, limits);
  Settings settings;
  settings.resolved = nlohmann::ordered_json::object();
  for (const Given& value : values) {
    const char* const name = value.setting->name;
    // Lists are kept as the text that they are for the worker.
    if (!given.contains(name))
      settings.resolved[name] = value.setting->access.show(options);
    else
      settings.resolved[name] = given[name].is_array() ? json(value.text) : given[name];
    if (!value.setting->is_flag() || value.text == "true") settings.arguments.push_back(argument_of(value));
  }
  if (given.contains("frames")) {
    settings.frames = parse_frames(options.frames);
    std::ranges::sort(*settings.frames);
  }
  return settings;
}

}  // namespace sheaf::server
