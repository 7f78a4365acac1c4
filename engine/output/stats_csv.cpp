// SPDX-License-Identifier: MIT
#include <algorithm>
#include <charconv>
#include <optional>
#include <utility>

#include "output/stats.hpp"

namespace sheaf {
namespace {

// Shortest text that reads back as the same number, whatever the locale.
std::string number(double value) {
  std::array<char, 32> text;
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value);
  return {text.data(), end};
}

std::string stage_time(const FrameStats& frame, const char* stage) {
  std::optional<double> time;
  for (const auto& [name, milliseconds] : frame.stages_ms)
    if (name == stage) time = time.value_or(0) + milliseconds;
  return time ? number(*time) : "";
}

double other_time(const FrameStats& frame) {
  double time = 0;
  for (const auto& [name, milliseconds] : frame.stages_ms)
    if (std::find(stage_names.begin(), stage_names.end(), name) == stage_names.end()) time += milliseconds;
  return time;
}

class Line {
 public:
  void add(const std::string& field) {
    if (!first_) text_ += ',';
    first_ = false;
    text_ += field;
  }
  void add(const PerKind<std::uint64_t>& counts, bool known) {
    for (const std::uint64_t count : counts) add(known ? std::to_string(count) : "");
  }
  void add_kinds(const std::string& what) {
    for (std::size_t kind = 0; kind < ray_kinds; ++kind) add(what + "_" + name_of(static_cast<RayKind>(kind)));
  }
  [[nodiscard]] std::string end() && { return std::move(text_) + "\n"; }

 private:
  std::string text_;
  bool first_ = true;
};

std::string header() {
  Line line;
  for (const char* name : {"frame", "time_s", "wall_ms", "peak_device_mib", "counted", "repeated"}) line.add(name);
  for (const char* stage : stage_names) line.add(std::string(stage) + "_ms");
  line.add("other_ms");
  line.add_kinds("rays");
  line.add_kinds("hits");
  line.add("brute_force");
  for (const char* tests : {"node_object", "ray_box", "ray_triangle"}) line.add_kinds(tests);
  return std::move(line).end();
}

std::string row(const FrameStats& frame) {
  Line line;
  line.add(std::to_string(frame.frame));
  for (const double value : {frame.time_s, frame.wall_ms, frame.peak_device_mib}) line.add(number(value));
  for (const bool flag : {frame.counted, frame.repeated}) line.add(flag ? "1" : "0");
  for (const char* stage : stage_names) line.add(stage_time(frame, stage));
  line.add(number(other_time(frame)));
  line.add(frame.rays, true);
  line.add(frame.hits, true);
  line.add(std::to_string(frame.brute_force));
  for (const auto* tests : {&frame.node_object, &frame.ray_box, &frame.ray_triangle}) line.add(*tests, frame.counted);
  return std::move(line).end();
}

}  // namespace

std::string to_csv(const RunStats& run) {
  std::string csv = header();
  for (const FrameStats& frame : run.frames) csv += row(frame);
  return csv;
}

}  // namespace sheaf
