// SPDX-License-Identifier: MIT
// The table of settings: whatever must know which settings there are asks it. The command line, the checks, what frames
// say of their settings, the service's checks and contract, its page, the Python package and docs/options.md follow.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "settings/render_settings.hpp"

namespace sheaf {

enum class Group { scene, picture, light, layers, tracing, files, run };
constexpr auto choice_names(Group) {
  return std::array{"scene", "picture", "light", "layers", "tracing", "files", "run"};
}

enum class Decides {
  view,    // which scene, camera and time the picture shows
  pixels,  // the pixels: written into frames as sheaf:settings
  speed,   // time and memory
  output,  // what else is written and said
};
constexpr auto choice_names(Decides) { return std::array{"view", "pixels", "speed", "output"}; }

/// How the value in RenderOptions is reached, by functions of its type. Reasons are empty where all is well.
struct Access {
  const Kind* kind = nullptr;
  std::string (*read)(std::string_view text, RenderOptions& options) = nullptr;
  std::string (*outside)(const RenderOptions& options, const Range& range) = nullptr;
  nlohmann::ordered_json (*show)(const RenderOptions& options) = nullptr;  // null: not given
  std::uint64_t (*amount)(const RenderOptions& options) = nullptr;         // what a service's limit counts
};

struct Setting {
  Access access;
  const char* name = nullptr;  // of the option, without the dashes
  Group group = Group::run;
  const char* help = "";
  const char* syntax = nullptr;  // null: the kind's
  Range range{};
  const char* unit = "";
  Decides decides = Decides::output;
  bool required = false;
  bool http = false;              // whether a job's settings may hold it
  const char* part = nullptr;     // of a job's upload that it comes as
  const char* limit = nullptr;    // of the service, that its amount is held against
  const char* service = nullptr;  // the service's own default
  bool visitors = true;           // whether the service's page offers it

  [[nodiscard]] const Kind& kind() const { return *access.kind; }
  [[nodiscard]] bool is_flag() const { return std::string_view(kind().syntax).empty(); }
  [[nodiscard]] const char* form() const { return syntax != nullptr ? syntax : kind().syntax; }
};

[[nodiscard]] std::span<const Setting> settings_table();
[[nodiscard]] const Setting* find_setting(std::string_view name);  // null where there is none

/// A value that was given, as text.
struct Given {
  const Setting* setting;
  std::string text;
};

/// Puts what a preset stands for before the rest, without what is given itself. Error{usage} for an unknown preset.
[[nodiscard]] std::vector<Given> with_presets(std::vector<Given> given);

/// Reads a value and holds it against its range. Throws Error naming the option, the value and the reason: usage where
/// it is no value of its kind, input where it is out of range.
void read_setting(const Given& given, RenderOptions& options);

/// Two settings that exclude each other; nothing where all go together.
struct Conflict {
  const Setting* setting;
  std::string reason;
};
[[nodiscard]] std::optional<Conflict> find_conflict(const RenderOptions& options);

/// Reads everything, presets included, and checks that it goes together.
void read_settings(const std::vector<Given>& given, RenderOptions& options);

/// The settings that decide pixels, as frames and stats tell them.
[[nodiscard]] nlohmann::ordered_json settings_json(const RenderOptions& options);

}  // namespace sheaf
