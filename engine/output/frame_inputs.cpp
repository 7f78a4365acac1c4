// SPDX-License-Identifier: MIT
#include "output/frame_inputs.hpp"

#include <ImfDoubleAttribute.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfIntAttribute.h>
#include <ImfStringAttribute.h>

#include <filesystem>
#include <string_view>

namespace sheaf {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view software = "Sheaf ";

// Names of the members that one has and the other has not, or differently.
std::string different_members(const std::string& a, const std::string& b) {
  const Json there = Json::parse(a, nullptr, false), wanted = Json::parse(b, nullptr, false);
  if (!there.is_object() || !wanted.is_object()) return {};
  std::string names;
  const auto add = [&](const std::string& name) { names += (names.empty() ? "" : ", ") + name; };
  for (const auto& [name, value] : wanted.items())
    if (!there.contains(name) || there[name] != value) add(name);
  for (const auto& [name, value] : there.items())
    if (!wanted.contains(name)) add(name);
  return names;
}

}  // namespace

std::optional<FrameInputs> read_frame_inputs(const std::string& path) noexcept {
  try {
    if (!std::filesystem::is_regular_file(path)) return std::nullopt;
    constexpr int threads = 0;
    const Imf::InputFile file(path.c_str(), threads);
    const Imf::Header& header = file.header();
    const auto* by = header.findTypedAttribute<Imf::StringAttribute>("software");
    const auto* scene = header.findTypedAttribute<Imf::StringAttribute>("sheaf:sceneHash");
    const auto* settings = header.findTypedAttribute<Imf::StringAttribute>("sheaf:settings");
    const auto* frame = header.findTypedAttribute<Imf::IntAttribute>("sheaf:frame");
    const auto* time = header.findTypedAttribute<Imf::DoubleAttribute>("sheaf:time");
    if (by == nullptr || scene == nullptr || settings == nullptr || frame == nullptr || time == nullptr)
      return std::nullopt;
    if (!by->value().starts_with(software)) return std::nullopt;
    return FrameInputs{by->value().substr(software.size()), scene->value(), settings->value(), frame->value(),
                       time->value()};
  } catch (...) {  // whatever is wrong with it, it is to be rendered again
    return std::nullopt;
  }
}

std::string difference(const FrameInputs& there, const FrameInputs& wanted) {
  if (there.version != wanted.version) return "another version (" + there.version + ")";
  if (there.scene_sha256 != wanted.scene_sha256) return "another scene";
  if (there.settings_json != wanted.settings_json) {
    const std::string names = different_members(there.settings_json, wanted.settings_json);
    return "other settings" + (names.empty() ? "" : ": " + names);
  }
  if (there.frame != wanted.frame) return "another frame's number";
  return there.time_s == wanted.time_s ? "" : "another time";
}

Json to_json(const FrameInputs& inputs) {
  return {{"frame", inputs.frame},
          {"time", inputs.time_s},
          {"version", inputs.version},
          {"scene", inputs.scene_sha256},
          {"settings", inputs.settings_json}};
}

}  // namespace sheaf
