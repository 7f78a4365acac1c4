// SPDX-License-Identifier: MIT
// The memory that scales with the picture: lists of rays, and what sorting and accumulation need. All of it is sized
// once from the budget (`--memory`); a tile whose rays do not fit is cut in two, so no ray is ever dropped.
#pragma once

#include <array>
#include <cstdint>

#include "device_data/features.hpp"
#include "vulkan/buffer.hpp"
#include "vulkan/recorder.hpp"

namespace sheaf {

struct RayList {
  Buffer rays, hits, order, optical_depth;
  void bind(Recorder& recorder) const {
    recorder.bind_list(LIST_RAYS, rays);
    recorder.bind_list(LIST_HITS, hits);
    recorder.bind_list(LIST_ORDER, order);
    if (optical_depth) recorder.bind(ROLE_OPTICAL_DEPTH, optical_depth);
  }
};

inline constexpr std::uint32_t max_records = 4096;

struct RayMemory {
  std::uint32_t capacity = 0;     // slots of a list
  std::uint32_t tile_pixels = 0;  // most pixels of a tile
  RayList shadow;
  std::array<RayList, 2> reflection, refraction;  // generations take turns; reflection[1] also holds the primary rays
  Buffer counters, args, block_sums, accumulation, visibility, output, readback, counters_readback;
  Buffer keys, order_kept, chunks, chunks_alt, digits, skeleton, ray_nodes;
  Buffer pixel_tests, pixel_tests_readback, layers, layers_readback, stats, stats_readback, frame;
  Buffer accumulation_readback, active_pixels, sample_places;  // of adaptive sampling
  Buffer records, records_readback;  // the counters as they stood after each list was traced, for the stats
};

/// What walks of packets or cells take of --memory for their pairs: a quarter.
[[nodiscard]] inline std::uint64_t walk_budget(const RenderSettings& settings) {
  return (settings.memory_mib << 20U) / 4;
}

/// Throws Error{limit} where the budget is too small for one pixel with these lights.
[[nodiscard]] RayMemory make_ray_memory(const Device& device, const RenderSettings& settings, const Plan& plan,
                                        const Features& features, std::uint32_t lights);

}  // namespace sheaf
