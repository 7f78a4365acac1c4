// SPDX-License-Identifier: MIT
#include "output/stats.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "output/atomic_file.hpp"

namespace sheaf {
namespace {

using Json = nlohmann::ordered_json;
using Counts = PerKind<std::uint64_t>;

constexpr std::array kind_names{"primary", "shadow", "reflection", "refraction"};
static_assert(kind_names.size() == ray_kinds);

// A sum that stops at the largest number: a total that wrapped around would look like a small one.
std::uint64_t add(std::uint64_t a, std::uint64_t b) {
  constexpr std::uint64_t most = std::numeric_limits<std::uint64_t>::max();
  return a > most - b ? most : a + b;
}

void add_to(Counts& sums, const Counts& counts) {
  for (std::size_t kind = 0; kind < ray_kinds; ++kind) sums[kind] = add(sums[kind], counts[kind]);
}

std::uint64_t sum(const Counts& counts) { return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0}, add); }

Json quotient(double above, double below) { return below > 0 ? Json(above / below) : Json(nullptr); }

Json all_kinds(const Counts& counts) {
  Json json = Json::object();
  for (std::size_t kind = 0; kind < ray_kinds; ++kind) json[kind_names[kind]] = counts[kind];
  return json;
}

template <typename T>
Json kinds_with(const Counts& rays, const PerKind<T>& values) {
  Json json = Json::object();
  for (std::size_t kind = 0; kind < ray_kinds; ++kind)
    if (rays[kind] > 0) json[kind_names[kind]] = values[kind];
  return json;
}

Json tests_of(const FrameStats& frame) {
  const Counts rays = frame.counted ? frame.rays : Counts{};
  return {{"brute_force", frame.brute_force},
          {"node_object", kinds_with(rays, frame.node_object)},
          {"node_object_by_level", kinds_with(rays, frame.node_object_by_level)},
          {"ray_box", kinds_with(rays, frame.ray_box)},
          {"ray_triangle", kinds_with(rays, frame.ray_triangle)}};
}

Json generation_json(const GenerationStats& generation) {
  return {{"generation", generation.index},
          {"kind", name_of(generation.kind)},
          {"rays", generation.rays},
          {"chunks", generation.chunks},
          {"nodes", generation.nodes},
          {"tight", generation.tight},
          {"sorted", generation.sorted},
          {"key_bits", generation.key_bits},
          {"sort_reason", generation.sort_reason},
          {"pairs_per_level", generation.pairs_per_level}};
}

Json frame_json(const FrameStats& frame) {
  Json stages = Json::object();
  for (const auto& [name, milliseconds] : frame.stages_ms) stages[name] = milliseconds;
  Json generations = Json::array();
  for (const GenerationStats& generation : frame.generations) generations.push_back(generation_json(generation));
  return {{"frame", frame.frame},           {"time_s", frame.time_s},
          {"wall_ms", frame.wall_ms},       {"peak_device_mib", frame.peak_device_mib},
          {"dispatches", frame.dispatches}, {"counted", frame.counted},
          {"repeated", frame.repeated},     {"stages", std::move(stages)},
          {"rays", all_kinds(frame.rays)},  {"hits", all_kinds(frame.hits)},
          {"tests", tests_of(frame)},       {"generations", std::move(generations)},
          {"strategies", frame.strategies}, {"blended_stopped", frame.stopped}};
}

// Sums for the totals. Rays and brute force appear twice: of all frames, and of those whose tests were counted, since
// only these can be set against the tests.
struct Sums {
  Counts rays{}, hits{}, node_object{}, ray_box{}, ray_triangle{}, counted_rays{};
  PerKind<double> counted_brute_force{};
  std::uint64_t brute_force = 0;
  double wall_ms = 0, timed_rays = 0, timed_wall_ms = 0, peak_device_mib = 0;
  Json stages = Json::object();

  void add_frame(const FrameStats& frame);
  void add_tests(const FrameStats& frame);
  [[nodiscard]] double tests_of_kind(std::size_t kind) const {
    return static_cast<double>(node_object[kind]) + static_cast<double>(ray_box[kind]) +
           static_cast<double>(ray_triangle[kind]);
  }
};

void Sums::add_frame(const FrameStats& frame) {
  add_to(rays, frame.rays);
  add_to(hits, frame.hits);
  brute_force = add(brute_force, frame.brute_force);
  wall_ms += frame.wall_ms;
  peak_device_mib = std::max(peak_device_mib, frame.peak_device_mib);
  for (const auto& [name, milliseconds] : frame.stages_ms) stages[name] = stages.value(name, 0.0) + milliseconds;
  if (!frame.repeated) {
    timed_rays += static_cast<double>(sum(frame.rays));
    timed_wall_ms += frame.wall_ms;
  }
  if (frame.counted) add_tests(frame);
}

void Sums::add_tests(const FrameStats& frame) {
  add_to(counted_rays, frame.rays);
  add_to(node_object, frame.node_object);
  add_to(ray_box, frame.ray_box);
  add_to(ray_triangle, frame.ray_triangle);
  const std::uint64_t frame_rays = sum(frame.rays);
  if (frame_rays == 0) return;
  // brute_force is rays × triangles, so a kind's share is that of its rays.
  const double per_ray = static_cast<double>(frame.brute_force) / static_cast<double>(frame_rays);
  for (std::size_t kind = 0; kind < ray_kinds; ++kind)
    counted_brute_force[kind] += per_ray * static_cast<double>(frame.rays[kind]);
}

Json reduction(double tests, double brute_force) {
  return brute_force > 0 ? Json(1 - tests / brute_force) : Json(nullptr);
}

Json totals_json(const RunStats& run) {
  Sums sums;
  for (const FrameStats& frame : run.frames) sums.add_frame(frame);
  double tests = 0, counted_rays = 0, counted_brute_force = 0;
  Json tests_per_ray = Json::object(), reductions = Json::object();
  for (std::size_t kind = 0; kind < ray_kinds; ++kind) {
    if (sums.counted_rays[kind] == 0) continue;
    const double of_kind = sums.tests_of_kind(kind), rays = static_cast<double>(sums.counted_rays[kind]);
    tests_per_ray[kind_names[kind]] = of_kind / rays;
    reductions[kind_names[kind]] = reduction(of_kind, sums.counted_brute_force[kind]);
    tests += of_kind;
    counted_rays += rays;
    counted_brute_force += sums.counted_brute_force[kind];
  }
  return {
      {"frames", run.frames.size()},
      {"counted_frames", std::count_if(run.frames.begin(), run.frames.end(), [](const auto& f) { return f.counted; })},
      {"repeated_frames",
       std::count_if(run.frames.begin(), run.frames.end(), [](const auto& f) { return f.repeated; })},
      {"wall_ms", sums.wall_ms},
      {"peak_device_mib", sums.peak_device_mib},
      {"stages", std::move(sums.stages)},
      {"rays", all_kinds(sums.rays)},
      {"hits", all_kinds(sums.hits)},
      {"tests",
       {{"brute_force", sums.brute_force},
        {"node_object", kinds_with(sums.counted_rays, sums.node_object)},
        {"ray_box", kinds_with(sums.counted_rays, sums.ray_box)},
        {"ray_triangle", kinds_with(sums.counted_rays, sums.ray_triangle)}}},
      {"rays_per_second", quotient(sums.timed_rays * 1000, sums.timed_wall_ms)},
      {"tests_per_ray", quotient(tests, counted_rays)},
      {"tests_per_ray_by_kind", std::move(tests_per_ray)},
      {"reduction_vs_brute_force", reduction(tests, counted_brute_force)},
      {"reduction_vs_brute_force_by_kind", std::move(reductions)}};
}

Json scene_json(const SceneStats& scene) {
  return {{"triangles", scene.triangles},
          {"instances", scene.instances},
          {"meshes", scene.meshes},
          {"lights", scene.lights},
          {"materials", scene.materials},
          {"features", scene.features},
          {"extensions_read", scene.extensions_read},
          {"extensions_ignored", scene.extensions_ignored},
          {"warnings", scene.warnings}};
}

}  // namespace

const char* name_of(RayKind kind) { return kind_names.at(static_cast<std::size_t>(kind)); }

nlohmann::ordered_json to_json(const RunStats& run) {
  Json left_out = Json::array(), frames = Json::array();
  for (const LeftOut& stage : run.left_out) left_out.push_back({{"stage", stage.stage}, {"reason", stage.reason}});
  for (const FrameStats& frame : run.frames) frames.push_back(frame_json(frame));
  return {{"schema", 1},
          {"version", run.version},
          {"device", {{"name", run.device_name}, {"driver", run.driver}}},
          {"strategy", run.strategy},
          {"chosen_because", run.chosen_because},
          {"settings", run.settings},
          {"scene", scene_json(run.scene)},
          {"left_out", std::move(left_out)},
          {"frames", std::move(frames)},
          {"totals", totals_json(run)}};
}

void write_stats(const std::string& path, const RunStats& run) {
  constexpr int indent = 2;
  write_file_atomically(path, to_json(run).dump(indent, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace sheaf
