// SPDX-License-Identifier: MIT
#include "jobs/work_totals.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "jobs/job_files.hpp"

namespace sheaf::server {
namespace {

using nlohmann::json;

constexpr std::uint64_t max_stats_bytes = std::uint64_t{64} << 20;
constexpr std::size_t max_series = 64;  // a worker cannot make metrics without end

json member(const json& object, const char* name) {
  const auto found = object.is_object() ? object.find(name) : object.end();
  return object.is_object() && found != object.end() ? *found : json();
}

std::uint64_t count(const json& value) { return value.is_number_unsigned() ? value.get<std::uint64_t>() : 0; }

std::string text(const json& value) { return value.is_string() ? value.get<std::string>().substr(0, 200) : ""; }

template <typename Key>
bool has_room(const std::map<Key, std::uint64_t>& series, const Key& key) {
  return series.size() < max_series || series.contains(key);
}

void add_frame(const json& frame, WorkTotals::Sums& sums) {
  const auto add_time = [&](const std::string& stage, const json& ms) {
    const bool room = sums.stages.size() < max_series || sums.stages.contains(stage);
    if (room && ms.is_number() && ms.get<double>() >= 0) sums.stages[stage].add(ms.get<double>() / 1000);
  };
  const json stages = member(frame, "stages"), rays = member(frame, "rays"), tests = member(frame, "tests"),
             peak = member(frame, "peak_device_mib");
  add_time("frame", member(frame, "wall_ms"));
  for (const auto& [stage, ms] : stages.items()) add_time(stage, ms);
  for (const auto& [kind, number] : rays.items())
    if (has_room(sums.rays, kind)) sums.rays[kind] += count(number);
  for (const auto& [test, kinds] : tests.items()) {
    if (!kinds.is_object()) continue;                 // brute_force is a number: what was not done
    for (const auto& [kind, number] : kinds.items())  // by level they are lists
      if (number.is_number() && has_room(sums.tests, {test, kind})) sums.tests[{test, kind}] += count(number);
  }
  if (peak.is_number()) sums.peak_device_mib = std::max(sums.peak_device_mib, peak.get<double>());
}

}  // namespace

void Histogram::add(double value) {
  ++counts[static_cast<std::size_t>(std::ranges::lower_bound(bounds, value) - bounds.begin())];
  sum += value;
}

void WorkTotals::add(const std::filesystem::path& stats) {
  json run;
  try {
    run = json::parse(read_text(stats, max_stats_bytes), nullptr, false);
  } catch (const Error&) {
    return;  // a worker that failed early has none
  }
  const std::lock_guard lock(mutex_);
  const json device = member(run, "device"), frames = member(run, "frames");
  if (device.is_object()) sums_.device = text(member(device, "name")), sums_.driver = text(member(device, "driver"));
  if (!frames.is_array()) return;
  for (const json& frame : frames) add_frame(frame, sums_);
}

WorkTotals::Sums WorkTotals::sums() const {
  const std::lock_guard lock(mutex_);
  return sums_;
}

}  // namespace sheaf::server
