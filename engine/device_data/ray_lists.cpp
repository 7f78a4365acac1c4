// SPDX-License-Identifier: MIT
#include "device_data/ray_lists.hpp"

#include <algorithm>

#include "core/error.hpp"

namespace sheaf {
namespace {

constexpr std::uint64_t pixel_bytes = 32 + 8 + 16 * 2;        // accumulation, visibility, output and its read-back
constexpr std::uint64_t sort_bytes = 4 + 4 + 12 * 2 + 4 + 1;  // keys, kept order, chunks twice, skeleton, digit counts
constexpr std::uint64_t packet_bytes = 4 + 8;                 // key, and at worst a packet of its own
constexpr std::uint32_t least_capacity = 1024;

std::uint64_t bytes_per_slot(const Plan& plan, const Features& features) {
  std::uint64_t lists = 1;  // primary
  if (plan.shadows) lists += 1;
  if (plan.reflections) lists += 1;
  if (plan.refractions) lists += 2;
  // A slot: ray, hit, place in the order.
  std::uint64_t bytes = lists * (gpu::RAY_SLOT_BYTES + 8 + 4) + pixel_bytes;
  if (features.translucent() || features.masked) bytes += 12;
  if (plan.sorts) bytes += sort_bytes;
  if (plan.packets) bytes += packet_bytes;
  if (plan.ray_hierarchy) bytes += gpu::RAY_NODE_WORDS * 4 / 3 + 1;
  return bytes;
}

// Lists, sums and pixels are known by address; everything else must fit one binding.
std::uint64_t most_slots(std::uint64_t range, const RenderSettings& settings, std::uint64_t per_pixel) {
  constexpr std::uint64_t bound_bytes =
      12;  // a slot's chunk, optical depth or share of the ray hierarchy (and its top)
  constexpr std::uint64_t top_bytes = (gpu::MAX_LEVELS + 1) * gpu::RAY_NODE_WORDS * 4;
  const std::uint64_t pixel_bytes = settings.layers.any_surface() ? gpu::LAYER_WORDS * 4 : 8;  // or of the visibility
  return std::min((range - top_bytes) / bound_bytes, range / pixel_bytes * per_pixel);
}

RayList make_list(const Device& device, const char* name, const RayMemory& m, bool optical_depth) {
  RayList list;
  list.rays = Buffer(device, name, std::uint64_t{m.capacity} * gpu::RAY_SLOT_BYTES, Buffer::Kind::device, by_address);
  list.hits = Buffer(device, name, std::uint64_t{m.capacity} * 8, Buffer::Kind::device, by_address);
  list.order = Buffer(device, name, std::uint64_t{m.capacity} * 4, Buffer::Kind::device, by_address);
  if (optical_depth) list.optical_depth = Buffer(device, name, std::uint64_t{m.capacity} * 12);
  return list;
}

void make_sort_memory(const Device& device, RayMemory& m) {
  m.keys = Buffer(device, "keys", std::uint64_t{m.capacity} * 4);
  m.order_kept = Buffer(device, "kept order", std::uint64_t{m.capacity} * 4);
  m.chunks = Buffer(device, "chunks", std::uint64_t{m.capacity} * 12);
  m.chunks_alt = Buffer(device, "chunks", std::uint64_t{m.capacity} * 12);
  m.skeleton = Buffer(device, "skeleton", std::uint64_t{m.capacity} * 4);
  const std::uint64_t blocks = (std::uint64_t{m.capacity} + gpu::SCAN_BLOCK - 1) / gpu::SCAN_BLOCK;
  m.digits = Buffer(device, "digit counts", blocks * gpu::RADIX * 4);
}

}  // namespace

RayMemory make_ray_memory(const Device& device, const RenderSettings& settings, const Plan& plan,
                          const Features& features, std::uint32_t lights) {
  RayMemory m;
  const std::uint64_t budget = (settings.memory_mib << 20U) - (plan.packets ? walk_budget(settings) : 0);
  const std::uint64_t spare = plan.refractions && plan.reflections ? 2 : 1;  // a hit there makes up to two rays
  const std::uint64_t per_pixel = std::uint64_t{lights} * spare;
  const std::uint64_t wanted = std::uint64_t{settings.width} * settings.height * per_pixel;
  std::uint64_t slots = std::min(budget / bytes_per_slot(plan, features), wanted);
  slots = std::min(slots, most_slots(device.limits().storage_range, settings, per_pixel));
  slots = std::min<std::uint64_t>(slots, std::uint64_t{1} << 24U);
  slots = std::max<std::uint64_t>(slots, std::max<std::uint64_t>(least_capacity, per_pixel));
  m.capacity = static_cast<std::uint32_t>(slots);
  m.tile_pixels = static_cast<std::uint32_t>(std::max<std::uint64_t>(slots / per_pixel, 1));

  m.shadow = make_list(device, "shadow rays", m, true);
  m.reflection[1] = make_list(device, "primary rays", m, false);
  if (plan.reflections) m.reflection[0] = make_list(device, "reflection rays", m, false);
  if (plan.refractions)
    for (auto& list : m.refraction) list = make_list(device, "refraction rays", m, false);

  using Kind = Buffer::Kind;
  const std::uint64_t pixels = m.tile_pixels;
  m.counters = Buffer(device, "counters", gpu::COUNT_WORDS * 4);
  m.counters_readback = Buffer(device, "counters", gpu::COUNT_WORDS * 4, Kind::readback);
  m.args = Buffer(device, "dispatch arguments", gpu::ARGS_COUNT * 12);
  m.block_sums = Buffer(device, "block sums", (std::uint64_t{m.capacity} / gpu::SCAN_BLOCK + 2) * 4 * gpu::RADIX);
  m.accumulation = Buffer(device, "accumulation", pixels * 32, Kind::device, by_address);
  if (plan.raster) m.visibility = Buffer(device, "visibility", pixels * 8, Kind::device, by_address);
  if (!device.limits().cpu)  // there it is written where the host reads it
    m.output = Buffer(device, "output", pixels * 16, Kind::device, by_address);
  m.readback = Buffer(device, "read-back", pixels * 16, Kind::readback, by_address);
  if (plan.adaptive) {
    m.accumulation_readback = Buffer(device, "accumulation", pixels * 32, Kind::readback, by_address);
    m.active_pixels = Buffer(device, "active pixels", pixels * 4, Kind::upload);
    m.sample_places = Buffer(device, "sample places", (std::uint64_t{settings.samples.most} + 1) * 8, Kind::upload);
  }
  m.frame = Buffer(device, "frame", sizeof(gpu::Frame));
  m.stats = Buffer(device, "stats", gpu::STAT_SUMS * 8);
  m.stats_readback = Buffer(device, "stats", gpu::STAT_SUMS * 8, Kind::readback);
  m.records = Buffer(device, "records", std::uint64_t{max_records} * gpu::COUNT_WORDS * 4);
  m.records_readback = Buffer(device, "records", std::uint64_t{max_records} * gpu::COUNT_WORDS * 4, Kind::readback);
  if (settings.layers.tests) {
    m.pixel_tests = Buffer(device, "tests of a pixel", pixels * 4);
    m.pixel_tests_readback = Buffer(device, "tests of a pixel", pixels * 4, Kind::readback);
  }
  if (settings.layers.any_surface()) {
    m.layers = Buffer(device, "layers", pixels * gpu::LAYER_WORDS * 4);
    m.layers_readback = Buffer(device, "layers", pixels * gpu::LAYER_WORDS * 4, Kind::readback);
  }
  if (plan.sorts) make_sort_memory(device, m);
  if (plan.ray_hierarchy) {
    // Levels 1 and up of arity 4: a third of the rays, and at most one node more a level.
    const std::uint64_t nodes = std::uint64_t{m.capacity} / 3 + gpu::MAX_LEVELS + 1;
    m.ray_nodes = Buffer(device, "ray hierarchy", nodes * gpu::RAY_NODE_WORDS * 4);
  }
  return m;
}

}  // namespace sheaf
