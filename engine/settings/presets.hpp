// SPDX-License-Identifier: MIT
// Named settings, `--quality`: each stands for values of others, which count where those are not given themselves.
#pragma once

#include <span>

#include "settings/values.hpp"

namespace sheaf {

struct PresetValue {
  const char *setting, *text;  // as on the command line
};
struct Preset {
  const char* name;
  std::span<const PresetValue> values;
};

[[nodiscard]] std::span<const Preset> presets();
[[nodiscard]] std::span<const char* const> preset_names();

template <>
struct Value<PresetName> : TextValue<PresetName> {
  static const Kind kind;
  static std::string read(std::string_view text, PresetName& value);
  static nlohmann::ordered_json show(const PresetName&) { return nullptr; }  // what it stands for is shown
};

}  // namespace sheaf
