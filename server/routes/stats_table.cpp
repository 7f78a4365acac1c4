// SPDX-License-Identifier: MIT
#include "routes/stats_table.hpp"

#include "core/error.hpp"
#include "output/stats.hpp"

namespace sheaf::server {
namespace {

using nlohmann::ordered_json;

/// Counts by kind of ray; a kind without rays is absent.
PerKind<std::uint64_t> per_kind(const ordered_json& counts) {
  PerKind<std::uint64_t> values{};
  for (std::size_t kind = 0; kind < ray_kinds; ++kind)
    values[kind] = counts.value(name_of(static_cast<RayKind>(kind)), std::uint64_t{0});
  return values;
}

FrameStats frame_of(const ordered_json& json) {
  const ordered_json none = ordered_json::object();
  FrameStats frame;
  frame.frame = json.at("frame").get<std::int64_t>();
  frame.time_s = json.value("time_s", 0.0);
  frame.wall_ms = json.value("wall_ms", 0.0);
  frame.peak_device_mib = json.value("peak_device_mib", 0.0);
  frame.repeated = json.value("repeated", false);
  const ordered_json stages = json.value("stages", none);
  for (const auto& [stage, ms] : stages.items()) frame.stages_ms.emplace_back(stage, ms.get<double>());
  frame.rays = per_kind(json.value("rays", none));
  frame.hits = per_kind(json.value("hits", none));
  const ordered_json tests = json.value("tests", none);
  frame.counted = json.value("counted", tests.contains("ray_triangle"));
  frame.brute_force = tests.value("brute_force", std::uint64_t{0});
  frame.node_object = per_kind(tests.value("node_object", none));
  frame.ray_box = per_kind(tests.value("ray_box", none));
  frame.ray_triangle = per_kind(tests.value("ray_triangle", none));
  return frame;
}

}  // namespace

std::string stats_csv(const std::string& json) {
  try {
    RunStats run;
    const ordered_json stats = ordered_json::parse(json);
    for (const ordered_json& frame : stats.at("frames")) run.frames.push_back(frame_of(frame));
    return to_csv(run);
  } catch (const ordered_json::exception& error) {
    throw input_error("stats.json", error.what());
  }
}

}  // namespace sheaf::server
