// SPDX-License-Identifier: MIT
#include "settings/setting_json.hpp"

#include <algorithm>
#include <cmath>

namespace sheaf {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

ordered_json choices_json(const Kind& kind) {
  auto list = ordered_json::array();
  for (const char* choice : kind.choices) list.push_back(choice);
  return list;
}

/// The value where nothing is given; null where that depends on the scene.
ordered_json default_of(const Setting& setting) {
  if (setting.required) return nullptr;
  static const RenderOptions defaults;
  return setting.access.show(defaults);
}

ordered_json preset_json() {
  auto all = ordered_json::object();
  for (const Preset& preset : presets()) {
    auto values = ordered_json::object();
    for (const PresetValue& value : preset.values) {
      const Setting& setting = *find_setting(value.setting);
      RenderOptions options;
      (void)setting.access.read(value.text, options);
      values[value.setting] = setting.access.show(options);
    }
    all[preset.name] = std::move(values);
  }
  return all;
}

bool names_presets(const Setting& setting) { return setting.kind().choices.data() == preset_names().data(); }

ordered_json bound(double value) {  // a whole one without ".0"
  const auto whole = static_cast<std::int64_t>(value);
  return value == static_cast<double>(whole) ? ordered_json(whole) : ordered_json(value);
}

ordered_json range_json(const Range& range) { return {bound(range.low), bound(range.high)}; }

void add_bounds(ordered_json& schema, const Range& range) {
  if (!range.bounded()) return;
  schema[range.above ? "exclusiveMinimum" : "minimum"] = bound(range.low);
  schema["maximum"] = bound(range.high);
}

ordered_json scalar_schema(const Setting& setting) {
  const JsonForm& form = setting.kind().json;
  ordered_json schema{{"type", form.scalar}};
  if (std::string_view(setting.kind().name) == "name-or-index")
    schema["minimum"] = 0;
  else
    add_bounds(schema, setting.range);
  return schema;
}

ordered_json text_schema(const JsonForm& form) {
  ordered_json schema{{"type", "string"}, {"minLength", 1}, {"maxLength", form.most_bytes}};
  if (form.pattern != nullptr) schema["pattern"] = form.pattern;
  return schema;
}

ordered_json array_schema(const Setting& setting) {
  const JsonForm& form = setting.kind().json;
  ordered_json items{{"type", form.items}};
  add_bounds(items, setting.range);
  if (!setting.kind().choices.empty()) items["enum"] = choices_json(setting.kind());
  ordered_json schema{{"type", "array"}, {"minItems", std::max<std::size_t>(form.count, 1)}};
  if (form.count > 0) schema["maxItems"] = form.count;
  schema["items"] = std::move(items);
  return schema;
}

ordered_json value_schema(const Setting& setting) {
  const JsonForm& form = setting.kind().json;
  if (!setting.kind().choices.empty() && form.items == nullptr) return {{"enum", choices_json(setting.kind())}};
  auto forms = ordered_json::array();
  if (form.scalar != nullptr) forms.push_back(scalar_schema(setting));
  if (form.text) forms.push_back(text_schema(form));
  if (form.items != nullptr) forms.push_back(array_schema(setting));
  return forms.size() == 1 ? forms.front() : ordered_json{{"oneOf", std::move(forms)}};
}

/// "a number, "N|N/M" or a list of …": what JSON may give for the setting.
std::string wanted(const Setting& setting) {
  const Kind& kind = setting.kind();
  const JsonForm& form = kind.json;
  if (!kind.choices.empty() && form.items == nullptr) return one_of(kind.choices);
  if (form.scalar != nullptr && std::string_view(form.scalar) == "boolean") return "must be true or false";
  std::vector<std::string> forms;
  if (form.scalar != nullptr)
    forms.emplace_back(std::string_view(form.scalar) == "integer" ? "a whole number" : "a number");
  if (form.text) forms.push_back("\"" + std::string(setting.form()) + "\"");
  if (form.items != nullptr)
    forms.push_back(form.count > 0 ? "a list of " + std::to_string(form.count) + " of them" : "a list of them");
  std::string text = "must be ";
  for (std::size_t i = 0; i < forms.size(); ++i)
    text += (i == 0 ? "" : i + 1 == forms.size() ? " or " : ", ") + forms[i];
  return text;
}

bool is_a(const json& value, std::string_view type) {
  if (type == "boolean") return value.is_boolean();
  if (type == "integer") return value.is_number_integer();
  if (type == "number") return value.is_number();
  return value.is_string();
}

std::string string_reason(const std::string& text, const JsonForm& form) {
  if (text.empty() || text.size() > form.most_bytes)
    return "must have 1 to " + std::to_string(form.most_bytes) + " bytes";
  if (std::ranges::any_of(text, [](char c) { return static_cast<unsigned char>(c) < 32 || c == 127; }))
    return "holds a control character";
  return {};
}

std::string from_array(const Setting& setting, const json& value, std::string& text) {
  const JsonForm& form = setting.kind().json;
  if (value.empty() || (form.count > 0 && value.size() != form.count)) return wanted(setting);
  for (const json& item : value) {
    if (!is_a(item, form.items)) return wanted(setting);
    const std::string part = item.is_string() ? item.get<std::string>() : item.dump();
    if (item.is_string() && (part.empty() || part.find(form.separator) != std::string::npos)) return wanted(setting);
    if (!text.empty()) text += form.separator;
    text += part;
  }
  return string_reason(text, form);
}

}  // namespace

ordered_json settings_description() {
  auto list = ordered_json::array();
  for (const Setting& setting : settings_table()) {
    const Kind& kind = setting.kind();
    ordered_json entry{{"name", setting.name}, {"type", kind.name}, {"syntax", setting.form()}};
    entry["range"] = nullptr;
    if (setting.range.bounded()) entry["range"] = range_json(setting.range);
    if (setting.range.above) entry["above"] = true;
    entry["choices"] = kind.choices.empty() ? ordered_json() : choices_json(kind);
    if (names_presets(setting)) entry["presets"] = preset_json();
    entry["default"] = default_of(setting);
    entry["unit"] = setting.unit;
    entry["help"] = setting.help;
    entry["group"] = name_of(setting.group);
    entry["decides"] = name_of(setting.decides);
    entry["required"] = setting.required;
    entry["http"] = setting.http;
    entry["part"] = setting.part != nullptr ? ordered_json(setting.part) : ordered_json();
    entry["limit"] = setting.limit != nullptr ? ordered_json(setting.limit) : ordered_json();
    list.push_back(std::move(entry));
  }
  return list;
}

ordered_json settings_schema() {
  auto properties = ordered_json::object();
  for (const Setting& setting : settings_table()) {
    if (!setting.http) continue;
    ordered_json schema = value_schema(setting);
    schema["description"] = setting.help;
    bool served = false;
    if (setting.service != nullptr) {
      RenderOptions options;
      served = setting.access.read(setting.service, options).empty();
      schema["default"] = setting.access.show(options);
    }
    if (const ordered_json value = default_of(setting); !served && !value.is_null()) schema["default"] = value;
    schema["x-type"] = setting.kind().name;
    schema["x-syntax"] = setting.form();
    schema["x-group"] = name_of(setting.group);
    if (*setting.unit != '\0') schema["x-unit"] = setting.unit;
    if (setting.range.bounded()) schema["x-range"] = range_json(setting.range);
    if (setting.limit != nullptr) schema["x-limit"] = setting.limit;
    if (names_presets(setting)) schema["x-presets"] = preset_json();
    schema["x-visitors"] = setting.visitors;
    properties[setting.name] = std::move(schema);
  }
  return properties;
}

std::string text_from_json(const Setting& setting, const json& value, std::string& text) {
  const JsonForm& form = setting.kind().json;
  text.clear();
  if (form.scalar != nullptr && is_a(value, form.scalar)) {
    text = value.dump();
    return {};
  }
  if (form.items != nullptr && value.is_array()) return from_array(setting, value, text);
  if (!form.text || !value.is_string()) return wanted(setting);
  text = value.get<std::string>();
  double number = 0;
  if (form.pattern != nullptr && form.scalar != nullptr && read_number(text, number) && std::isfinite(number))
    return wanted(setting);
  return string_reason(text, form);
}

}  // namespace sheaf
