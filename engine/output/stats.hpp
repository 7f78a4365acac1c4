// SPDX-License-Identifier: MIT
// What a run measured, and how it is written: `--stats` JSON (schema 1) and CSV.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

namespace sheaf {

enum class RayKind : std::uint32_t { primary = 0, shadow = 1, reflection = 2, refraction = 3 };
inline constexpr std::size_t ray_kinds = 4;
[[nodiscard]] const char* name_of(RayKind kind);

template <typename T>
using PerKind = std::array<T, ray_kinds>;  // indexed by RayKind

/// Stages in pipeline order: the names used in FrameStats::stages_ms, and the CSV's columns.
inline constexpr std::array stage_names{"animate",  "objects",   "raster",     "generate",       "hash",
                                        "compress", "sort",      "decompress", "rays_hierarchy", "traverse",
                                        "compact",  "intersect", "shade",      "resolve",        "write"};

struct GenerationStats {
  std::uint32_t index = 0;
  RayKind kind = RayKind::primary;
  std::uint64_t rays = 0, chunks = 0, nodes = 0;
  std::uint64_t tight = 0;  // of the nodes: bundles that were walked whole
  bool sorted = false;
  std::uint32_t key_bits = 0;
  std::string sort_reason;                     // why it was sorted, or not
  std::vector<std::uint64_t> pairs_per_level;  // root first
};

struct FrameStats {
  std::int64_t frame = 0;
  // wall_ms: from the request to the pixels; writing runs beside the next frame.
  double time_s = 0, wall_ms = 0, peak_device_mib = 0;
  std::uint64_t dispatches = 0;                           // of kernels, also over lists that turn out empty
  std::vector<std::pair<std::string, double>> stages_ms;  // pipeline order; a stage left out is absent
  PerKind<std::uint64_t> rays{}, hits{};
  PerKind<std::uint64_t> node_object{}, ray_box{}, ray_triangle{};  // meaningful only where counted
  PerKind<std::vector<std::uint64_t>> node_object_by_level;
  std::uint64_t brute_force = 0;  // rays × triangles
  std::uint64_t stopped = 0;      // rays that went through as many blended surfaces as a ray may
  bool counted = false;           // tests were counted in this frame
  bool repeated = false;          // pixels are those of an earlier identical frame; nothing was traced
  std::vector<GenerationStats> generations;
  std::vector<std::string> strategies;  // that traced it, in the order they first did
};

struct LeftOut {
  std::string stage, reason;
};

struct SceneStats {
  std::uint64_t triangles = 0, instances = 0, meshes = 0, lights = 0, materials = 0;
  std::vector<std::string> features, extensions_read, extensions_ignored, warnings;
};

struct RunStats {
  std::string version, device_name, driver, strategy, chosen_because;
  SceneStats scene;
  std::vector<LeftOut> left_out;
  std::vector<FrameStats> frames;
  nlohmann::ordered_json settings;
};

/// Schema 1, keys in the schema's order. A test map holds only kinds that had rays, and none in an uncounted frame.
/// `totals`: sums over frames (they stop at 2^64-1); tests_per_ray and reduction_vs_brute_force over counted frames,
/// rays_per_second over wall time without repeated frames; null where there is nothing to divide by.
[[nodiscard]] nlohmann::ordered_json to_json(const RunStats& run);

/// One line per frame under a header that never depends on the run. Times of stages outside `stage_names` add up in
/// `other_ms`. A stage left out and the tests of an uncounted frame are empty fields.
[[nodiscard]] std::string to_csv(const RunStats& run);

/// JSON, indented, under its name only when whole. Bytes that are not UTF-8 become U+FFFD.
void write_stats(const std::string& path, const RunStats& run);

}  // namespace sheaf
