// SPDX-License-Identifier: MIT
// What a finished tile leaves on the host: pixels, layers, counts.
#include <algorithm>

#include "frame/renderer.hpp"
#include "stages/sort.hpp"
#include "stages/traverse_classes.hpp"

namespace sheaf {
namespace {

// Root first; trees of different heights agree at the bottom.
void add_levels(std::vector<std::uint64_t>& sum, const std::vector<std::uint64_t>& more) {
  if (sum.size() < more.size()) sum.insert(sum.begin(), more.size() - sum.size(), 0);
  for (std::size_t below = 1; below <= more.size(); ++below) sum[sum.size() - below] += more[more.size() - below];
}

const char* why_sorted(const Plan& plan, const RenderSettings& settings, std::uint32_t kind) {
  if (!plan.sorts) return "left out";
  if (plan.classes) return "classes need it";
  if (kind == gpu::KIND_PRIMARY) return "camera rays are in order";
  return settings.sort == SortPolicy::on ? "--sort on" : "the strategy sorts";
}

}  // namespace

void Renderer::collect_generations(RenderedFrame& out) {
  const auto words = memory_.records_readback.view<std::uint32_t>();
  for (std::size_t r = 0; r < records_.size(); ++r) {
    const auto* counters = &words[r * gpu::COUNT_WORDS];
    const auto& [generation, kind, way, pairs] = records_[r];
    const Plan& plan = way->plan;
    if (counters[gpu::COUNT_RAYS + kind] == 0) continue;
    auto found =
        std::find_if(out.stats.generations.begin(), out.stats.generations.end(), [&](const GenerationStats& g) {
          return g.index == records_[r].generation && g.kind == static_cast<RayKind>(records_[r].kind);
        });
    if (found == out.stats.generations.end()) {
      out.stats.generations.push_back({});
      found = std::prev(out.stats.generations.end());
      found->index = generation;
      found->kind = static_cast<RayKind>(kind);
    }
    found->rays += counters[gpu::COUNT_RAYS + kind];
    add_levels(found->pairs_per_level, pairs);
    if (plan.bundles) {
      const std::uint32_t size = device_.limits().bundle;
      const std::uint32_t bundles = (counters[gpu::COUNT_RAYS + kind] + size - 1) / size;
      found->nodes += bundles;
      found->tight += bundles - counters[gpu::COUNT_INCOHERENT];
    } else if (plan.packets) {
      found->nodes += counters[gpu::COUNT_CELLS];
    }
    found->sorted = plan.sorts && (kind != gpu::KIND_PRIMARY || plan.classes);
    found->sort_reason = why_sorted(plan, settings_, kind);
    if (!found->sorted) continue;
    found->key_bits =
        plan.classes ? TraverseClasses::key_bits : key_layout(kind, scene_->lights(), memory_.tile_pixels).bits();
    found->chunks += counters[gpu::COUNT_CHUNKS];
  }
}

void Renderer::store_tile(const Tile& tile, RenderedFrame& out) {
  const auto pixels = memory_.readback.view<float>();
  for (std::uint32_t y = 0; y < tile.height; ++y)
    std::copy_n(pixels.begin() + static_cast<std::ptrdiff_t>(y) * tile.width * 4, std::size_t{tile.width} * 4,
                out.layers.rgba.begin() + (static_cast<std::ptrdiff_t>(tile.y + y) * settings_.width + tile.x) * 4);
  store_counts(tile, out);
}

void Renderer::store_counts(const Tile& tile, RenderedFrame& out) {
  if (layers_ && (!adaptive_ || adaptive_->first_sample() == 0))
    Layers::store(memory_, tile, scene_->origin(), settings_.z_background, out.layers);
  if (!out.layers.tests.empty()) {
    const auto tests = memory_.pixel_tests_readback.view<std::uint32_t>();
    for (std::uint32_t i = 0; i < tile.pixels(); ++i)
      out.layers.tests[std::size_t{tile.y + i / tile.width} * settings_.width + tile.x + i % tile.width] +=
          static_cast<float>(tests[i]);
  }
  collect_stats(out);
  collect_generations(out);
}

void Renderer::collect_stats(RenderedFrame& out) {
  const auto stats = memory_.stats_readback.view<std::uint64_t>();
  for (std::uint32_t kind = 0; kind < ray_kinds; ++kind) {
    const auto* of = &stats[kind * gpu::STAT_FIELDS];
    out.stats.rays[kind] += of[gpu::STAT_RAYS];
    out.stats.hits[kind] += of[gpu::STAT_HITS];
    out.stats.stopped += of[gpu::STAT_STOPPED];
    out.stats.node_object[kind] += of[gpu::STAT_NODE_OBJECT];
    out.stats.ray_box[kind] += of[gpu::STAT_RAY_BOX];
    out.stats.ray_triangle[kind] += of[gpu::STAT_RAY_TRIANGLE];
    auto& levels = out.stats.node_object_by_level[kind];  // root last: level 0 are the rays
    for (std::uint32_t l = 0; l < gpu::MAX_LEVELS; ++l) {
      if (of[gpu::STAT_LEVELS + l] == 0) continue;
      if (levels.size() <= l) levels.resize(l + 1);
      levels[l] += of[gpu::STAT_LEVELS + l];
    }
  }
}

}  // namespace sheaf
