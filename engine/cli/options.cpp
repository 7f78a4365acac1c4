// SPDX-License-Identifier: MIT
#include "cli/options.hpp"

#include <CLI/CLI.hpp>
#include <sstream>

namespace sheaf {
namespace {

std::string option_of(const Setting& setting) { return "--" + std::string(setting.name); }

/// "draft = --spp 1 --depth 2 --cutoff 0.02; …".
std::string preset_help() {
  std::ostringstream text;
  for (const Preset& preset : presets()) {
    text << (preset.name == presets().front().name ? "" : "; ") << preset.name << " =";
    for (const PresetValue& value : preset.values) text << " --" << value.setting << " " << value.text;
  }
  return text.str();
}

std::string help_of(const Setting& setting) {
  std::string help = setting.help;
  if (setting.kind().choices.data() == preset_names().data()) return help + ": " + preset_help();
  std::string list;
  for (const char* choice : setting.kind().choices) list += (list.empty() ? "" : ", ") + std::string(choice);
  return list.empty() ? help : help + " (" + list + ")";
}

std::string group_of(const Setting& setting) {
  std::string title = name_of(setting.group);
  title.front() = static_cast<char>(title.front() - 'a' + 'A');
  return title;
}

}  // namespace

RenderLine::RenderLine(CLI::App& command) : command_(command), texts_(settings_table().size()) {
  const RenderOptions defaults;
  command.add_option("scene", scene_, "a .glb or .gltf file")->required();
  for (std::size_t i = 0; i < texts_.size(); ++i) {
    const Setting& setting = settings_table()[i];
    if (setting.is_flag()) {
      command.add_flag(option_of(setting), setting.help)->group(group_of(setting));
      continue;
    }
    CLI::Option* const option = command.add_option(option_of(setting), texts_[i], help_of(setting));
    option->type_name(setting.form())->required(setting.required)->group(group_of(setting));
    const nlohmann::ordered_json value = setting.access.show(defaults);
    if (!value.is_null()) option->default_str(value.is_string() ? value.get<std::string>() : value.dump());
  }
}

std::vector<Given> RenderLine::given() const {
  std::vector<Given> all;
  for (std::size_t i = 0; i < texts_.size(); ++i) {
    const Setting& setting = settings_table()[i];
    if (command_.count(option_of(setting)) > 0) all.push_back({&setting, setting.is_flag() ? "true" : texts_[i]});
  }
  return all;
}

ProgressMode RenderLine::progress() const {
  RenderOptions options;
  for (const Given& one : given())
    if (one.setting == find_setting("progress")) read_setting(one, options);
  return options.progress;
}

RenderOptions RenderLine::options() const {
  RenderOptions options;
  options.scene = scene_;
  read_settings(given(), options);
  return options;
}

}  // namespace sheaf
