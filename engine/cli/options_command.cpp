// SPDX-License-Identifier: MIT
#include <cstdio>
#include <string>

#include "cli/commands.hpp"
#include "settings/setting_json.hpp"

namespace sheaf {
namespace {

std::string text_of(const nlohmann::ordered_json& value) {
  return value.is_string() ? value.get<std::string>() : value.dump();
}

/// Type, range, choices, default and where it is taken, in a line.
std::string facts_of(const nlohmann::ordered_json& entry) {
  std::string facts = entry.at("type");
  if (const auto& range = entry.at("range"); !range.is_null())
    facts += (entry.contains("above") ? ", above " : ", from ") + range[0].dump() + " to " + range[1].dump();
  if (const std::string unit = entry.at("unit"); !unit.empty()) facts += " " + unit;
  if (const auto& choices = entry.at("choices"); !choices.is_null()) {
    std::string list;
    for (const auto& choice : choices) list += (list.empty() ? ": " : ", ") + choice.get<std::string>();
    facts += list;
  }
  if (!entry.at("default").is_null()) facts += "; default " + text_of(entry.at("default"));
  if (entry.at("http").get<bool>())
    facts += "; over HTTP too";
  else if (!entry.at("part").is_null())
    facts += "; over HTTP as the part " + entry.at("part").get<std::string>();
  return facts;
}

}  // namespace

int run_options(bool json) {
  const nlohmann::ordered_json description = settings_description();
  if (json) {
    std::printf("%s\n", description.dump(2).c_str());
    return 0;
  }
  for (const auto& entry : description) {
    const std::string name = entry.at("name"), syntax = entry.at("syntax"), help = entry.at("help");
    std::printf("--%s%s%s\n    %s\n    %s\n", name.c_str(), syntax.empty() ? "" : " ", syntax.c_str(), help.c_str(),
                facts_of(entry).c_str());
  }
  return 0;
}

}  // namespace sheaf
