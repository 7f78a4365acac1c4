// SPDX-License-Identifier: MIT
#include <algorithm>
#include <iterator>

#include "settings/setting.hpp"

namespace sheaf {
namespace {

ImageSize& size_of(RenderSettings& settings) { return settings; }
const ImageSize& size_of(const RenderSettings& settings) { return settings; }

/// `Get` gives the value in the options, constant or not.
template <typename Get>
constexpr Access access(Get) {
  using T = std::remove_cvref_t<std::invoke_result_t<Get, RenderOptions&>>;
  return {&Value<T>::kind, [](std::string_view text, RenderOptions& o) { return Value<T>::read(text, Get{}(o)); },
          [](const RenderOptions& o, const Range& range) { return Value<T>::outside(Get{}(o), range); },
          [](const RenderOptions& o) { return Value<T>::show(Get{}(o)); },
          [](const RenderOptions& o) -> std::uint64_t { return Value<T>::amount(Get{}(o)); }};
}

// NOLINTBEGIN(cppcoreguidelines-macro-usage)
const Setting entries[] = {
#define PRESET(...)
#define SETTING(reach, ...) Setting{.access = reach, __VA_ARGS__},
#define PICTURE(type, member, fallback, ...) \
  SETTING(access([](auto& o) -> auto& { return o.settings.member; }), __VA_ARGS__)
#define RUN(type, member, fallback, ...) SETTING(access([](auto& o) -> auto& { return o.member; }), __VA_ARGS__)
#include "settings/table.def"
#undef PRESET
#undef SETTING
#undef PICTURE
#undef RUN
};

#define SETTING(...)
#define PICTURE(...)
#define RUN(...)
#define PRESET(name, ...)                                   \
  {name, [] {                                               \
     static constexpr PresetValue values[] = {__VA_ARGS__}; \
     return std::span<const PresetValue>(values);           \
   }()},
const Preset preset_entries[] = {
#include "settings/table.def"
};
#undef PRESET
#define PRESET(name, ...) name,
constexpr const char* names_of_presets[] = {
#include "settings/table.def"
};
// NOLINTEND(cppcoreguidelines-macro-usage)

}  // namespace

const Kind Value<PresetName>::kind{"choice", "NAME", {.text = true}, names_of_presets};

std::string Value<PresetName>::read(std::string_view text, PresetName& value) {
  if (std::ranges::find(names_of_presets, text) == std::end(names_of_presets)) return one_of(names_of_presets);
  value.assign(text);
  return {};
}

std::span<const Preset> presets() { return preset_entries; }
std::span<const char* const> preset_names() { return names_of_presets; }
std::span<const Setting> settings_table() { return entries; }

const Setting* find_setting(std::string_view name) {
  const auto found = std::ranges::find_if(entries, [&](const Setting& setting) { return name == setting.name; });
  return found == std::end(entries) ? nullptr : found;
}

}  // namespace sheaf
