// SPDX-License-Identifier: MIT
#include "jobs/settings.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "http/problem.hpp"
#include "output/frame_names.hpp"
#include "output/frame_range.hpp"
#include "sampling/quality.hpp"

namespace sheaf::server {
namespace {

using nlohmann::json;

struct Context {
  std::string key;
  const Limits& limits;
  Settings& settings;

  [[noreturn]] void refuse(const std::string& reason) const {
    throw Problem(ProblemKind::bad_settings, "settings." + key + ": " + reason).member("pointer", "/" + key);
  }
  void bound(std::uint64_t value, const char* name, std::uint64_t limit, const std::string& what) const {
    if (value > limit)
      throw Problem(ProblemKind::limit_exceeded, "settings." + key + ": " + std::to_string(value) + " " + what +
                                                     ", the limit is " + std::to_string(limit))
          .member("pointer", "/" + key)
          .passed(name, limit, value);
  }
};

/// Gives the argument's text; may change the settings.
using Check = std::string (*)(const json& value, Context& context);

std::uint64_t whole(const json& value, Context& context, std::uint64_t least) {
  if (!value.is_number_unsigned() || value.get<std::uint64_t>() < least)
    context.refuse("must be a whole number of at least " + std::to_string(least));
  return value.get<std::uint64_t>();
}

/// Free text that ends up in one argument or attribute: no control characters, not endless.
std::string text(const json& value, Context& context) {
  if (!value.is_string()) context.refuse("must be a string");
  const auto& string = value.get_ref<const std::string&>();
  if (string.empty() || string.size() > 255) context.refuse("must have 1 to 255 bytes");
  if (std::ranges::any_of(string, [](char c) { return static_cast<unsigned char>(c) < 32 || c == 127; }))
    context.refuse("holds a control character");
  return string;
}

std::string name_or_index(const json& value, Context& context) {
  return value.is_number() ? std::to_string(whole(value, context, 0)) : text(value, context);
}

template <const auto& choices>
std::string choice(const json& value, Context& context) {
  std::string list;
  for (const char* name : choices) {
    if (value.is_string() && value.get_ref<const std::string&>() == name) return name;
    list += std::string(list.empty() ? "" : ", ") + name;
  }
  context.refuse("must be one of " + list);
}

constexpr char max_spp[] = "max-spp", max_depth[] = "max-depth", max_memory[] = "max-memory";  // limits, by option

constexpr std::array strategies{"auto",     "hybrid", "crsh",  "rsh",      "frustum",
                                "classify", "bvh",    "brute", "rayquery", "reference"};
constexpr std::array filters{"box", "triangle", "gaussian"};
constexpr std::array switches{"auto", "on", "off"};
constexpr std::array primaries{"auto", "raster", "trace"};
constexpr std::array compressions{"none", "rle", "zips", "zip", "piz", "dwaa"};

std::string frames(const json& value, Context& context) {
  std::string list;
  if (value.is_number_integer()) {
    list = value.dump();
  } else if (value.is_string()) {
    list = value.get<std::string>();
  } else if (value.is_array() && !value.empty()) {
    for (const json& item : value) {
      if (!item.is_number_integer()) context.refuse("every frame of the list must be a whole number");
      list += (list.empty() ? "" : ",") + item.dump();
    }
  } else {
    context.refuse("must be \"A-B\", \"A-B:STEP\", \"N,M\", a whole number or a list of them");
  }
  try {
    context.settings.frames = parse_frames(list);
  } catch (const Error& error) {
    context.refuse(error.what());
  }
  context.bound(context.settings.frames->size(), "max-frames", context.limits.frames, "frames");
  std::ranges::sort(*context.settings.frames);
  return list;
}

std::string size(const json& value, Context& context) {
  std::array<std::uint64_t, 2> sides{};
  if (value.is_array() && value.size() == 2) {
    sides = {whole(value[0], context, 1), whole(value[1], context, 1)};
  } else {
    const std::string given = value.is_string() ? value.get<std::string>() : "";
    const auto cross = given.find('x');
    const char* const end = given.data() + given.size();
    const char* const middle = cross == std::string::npos ? end : given.data() + cross;
    const auto first = std::from_chars(given.data(), middle, sides[0]);
    const auto second = std::from_chars(std::min(middle + 1, end), end, sides[1]);
    if (cross == std::string::npos || first.ptr != middle || second.ptr != end || first.ec != std::errc{} ||
        second.ec != std::errc{} || sides[0] == 0 || sides[1] == 0)
      context.refuse("must be \"WIDTHxHEIGHT\" in pixels");
  }
  context.bound(std::max(sides[0], sides[1]), "side", 65'535, "pixels along a side");
  context.bound(sides[0] * sides[1], "max-pixels", context.limits.pixels, "pixels");
  return std::to_string(sides[0]) + "x" + std::to_string(sides[1]);
}

std::string fps(const json& value, Context& context) {
  if (value.is_number()) {
    const double rate = value.get<double>();
    if (!(rate > 0 && rate <= 1000)) context.refuse("must be above 0 and at most 1000");
    return value.dump();
  }
  const std::string ratio = text(value, context);
  const auto slash = ratio.find('/');
  std::uint64_t over = 0, under = 0;
  const char* const middle = slash == std::string::npos ? nullptr : ratio.data() + slash;
  const char* const end = ratio.data() + ratio.size();
  if (!middle || std::from_chars(ratio.data(), middle, over).ptr != middle ||
      std::from_chars(middle + 1, end, under).ptr != end || over == 0 || under == 0 || over / under > 1000)
    context.refuse("must be a number or \"24000/1001\"");
  return json(static_cast<double>(over) / static_cast<double>(under)).dump();
}

template <std::uint64_t Limits::*limit, const auto& name, std::uint64_t least = 1>
std::string bounded(const json& value, Context& context) {
  const std::uint64_t number = whole(value, context, least);
  context.bound(number, name, context.limits.*limit, "asked for");
  return std::to_string(number);
}

// The most samples of a pixel count against the limit.
std::string spp(const json& value, Context& context) {
  if (!value.is_string()) return bounded<&Limits::spp, max_spp>(value, context);
  const std::string given = text(value, context);
  const auto samples = parse_sample_count(given);
  if (!samples || !samples->error || !(*samples->error >= 1e-5 && *samples->error <= 1) || samples->most < 8)
    context.refuse(
        "must be a whole number of at least 1 or \"adaptive:ERROR[:MOST]\", ERROR from 0.00001 to 1, MOST from 8");
  context.bound(samples->most, max_spp, context.limits.spp, "asked for");
  return given;
}

// What it stands for is held against the same limits.
std::string quality(const json& value, Context& context) {
  const Quality* found = value.is_string() ? find_quality(value.get<std::string>()) : nullptr;
  if (found == nullptr) context.refuse("must be one of draft, production, exact");
  context.bound(found->samples.most, max_spp, context.limits.spp, "samples a pixel");
  context.bound(found->depth, max_depth, context.limits.depth, "generations");
  return found->name;
}

std::string cutoff(const json& value, Context& context) {
  if (!value.is_number() || !(value.get<double>() >= 0 && value.get<double>() <= 1))
    context.refuse("must be a number from 0 to 1");
  return value.dump();
}

std::string aov(const json& value, Context& context) {
  std::string list;
  if (value.is_string()) {
    list = value.get_ref<const std::string&>();
  } else if (value.is_array()) {
    for (const json& item : value) list += (list.empty() ? "" : ",") + text(item, context);
  }
  if (list.empty() || list.size() > 1024 || !std::ranges::all_of(list, [](char c) {
        return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == ',' || c == '_';
      }))
    context.refuse("must be layer names: \"Z,N,albedo\" or a list of them");
  return list;
}

std::string name(const json& value, Context& context) {
  const std::string pattern = text(value, context);
  try {
    (void)FrameNames(pattern);
  } catch (const Error& error) {
    context.refuse(error.what());
  }
  if (pattern.front() == '.') context.refuse("must not start with a dot");
  return pattern;
}

std::string environment(const json& value, Context& context) {
  const auto component = [&](const json& part) {
    if (!part.is_number() || !(part.get<double>() >= 0 && part.get<double>() <= 1e6))
      context.refuse("must be three numbers from 0 to 1000000");
    return part.dump();
  };
  const json parts = value.is_string() ? json::parse("[" + value.get<std::string>() + "]", nullptr, false) : value;
  if (!parts.is_array() || parts.size() != 3) context.refuse("must be \"R,G,B\" or [R, G, B]");
  return component(parts[0]) + "," + component(parts[1]) + "," + component(parts[2]);
}

std::string flag(const json& value, Context& context) {
  if (!value.is_boolean()) context.refuse("must be true or false");
  if (context.key == "preview") context.settings.preview = value.get<bool>();
  return value.get<bool>() ? "on" : "";
}

struct Setting {
  const char* name;
  Check check;
};

constexpr std::array table{Setting{"frames", frames},
                           Setting{"fps", fps},
                           Setting{"animation", name_or_index},
                           Setting{"camera-node", name_or_index},
                           Setting{"size", size},
                           Setting{"quality", quality},
                           Setting{"spp", spp},
                           Setting{"filter", choice<filters>},
                           Setting{"depth", bounded<&Limits::depth, max_depth, 0>},
                           Setting{"cutoff", cutoff},
                           Setting{"strategy", choice<strategies>},
                           Setting{"sort", choice<switches>},
                           Setting{"primary", choice<primaries>},
                           Setting{"aov", aov},
                           Setting{"compression", choice<compressions>},
                           Setting{"name", name},
                           Setting{"scene-name", name_or_index},
                           Setting{"environment", environment},
                           Setting{"count", choice<switches>},
                           Setting{"memory", bounded<&Limits::memory_mib, max_memory>},
                           Setting{"device", name_or_index},
                           Setting{"opaque", flag},
                           Setting{"preview", flag}};

// Of the command line, but the service's own to choose.
constexpr std::array reserved{"out", "camera", "stats", "dump", "progress", "resume"};

void refuse_unknown(const json& given) {
  for (const auto& [key, value] : given.items()) {
    if (std::ranges::any_of(table, [&name = key](const Setting& setting) { return name == setting.name; })) continue;
    const bool known = std::ranges::find(reserved, key) != reserved.end();
    throw Problem(ProblemKind::bad_settings,
                  "settings." + key + (known ? ": not accepted over HTTP" : ": there is no such setting"))
        .member("pointer", "/" + key);
  }
}

}  // namespace

Settings parse_settings(const json& given, bool has_camera, const Limits& limits) {
  if (!given.is_object()) throw Problem(ProblemKind::bad_settings, "settings: must be a JSON object");
  refuse_unknown(given);
  if (has_camera && given.contains("camera-node"))
    throw Problem(ProblemKind::bad_settings, "settings.camera-node: a camera part was uploaded as well")
        .member("pointer", "/camera-node");

  Settings settings;
  settings.resolved = nlohmann::ordered_json::object();
  for (const Setting& setting : table) {
    if (!given.contains(setting.name)) continue;
    Context context{setting.name, limits, settings};
    const json& value = given[setting.name];
    const std::string argument = setting.check(value, context);
    const bool is_flag = value.is_boolean();
    settings.resolved[setting.name] = value.is_array() ? json(argument) : value;
    if (is_flag && argument.empty()) continue;
    settings.arguments.push_back("--" + std::string(setting.name) + (is_flag ? "" : "=" + argument));
  }
  if (!given.contains("preview")) settings.arguments.emplace_back("--preview");
  settings.resolved["preview"] = settings.preview;
  return settings;
}

std::vector<std::string> setting_names() {
  std::vector<std::string> names;
  for (const Setting& setting : table) names.emplace_back(setting.name);
  return names;
}

}  // namespace sheaf::server
