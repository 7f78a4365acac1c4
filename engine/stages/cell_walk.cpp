// SPDX-License-Identifier: MIT
#include "stages/cell_walk.hpp"

#include <algorithm>

namespace sheaf {
namespace {

constexpr std::uint32_t least_room = 4096, most_room = 1U << 22U;  // pairs
constexpr std::uint32_t pairs_a_cell = 8;                          // that there is room for, all cells at work
constexpr std::uint32_t level_room = gpu::STACK_SIZE + 1;          // of the object hierarchy, and its leaves
constexpr std::uint32_t ray_level = 3;                             // of the rays' levels, as bundles of BUNDLE rays

std::uint32_t rounded(std::uint64_t items) {
  return static_cast<std::uint32_t>(items / gpu::SCAN_BLOCK * gpu::SCAN_BLOCK);
}

}  // namespace

CellWalk::CellWalk(const TraceContext& c)
    : context_(c),
      begin_(c.device, "walk_begin"),
      ranges_(c.device, "pairs_ranges"),
      compact_(c.device, "open"),
      single_(c, false) {
  const std::vector<SpecConstant> counting{{6, c.counted}};
  open_ = Kernel(c.device, "pairs_open", counting);
  const std::uint32_t lanes = std::min(c.device.limits().subgroup, gpu::BUNDLE);
  auto make = [&](bool any_hit) {
    auto constants = candidate_constants(c, any_hit);
    constants.insert(constants.end(), {{0, lanes}, {10, lanes}, {11, gpu::BUNDLE / lanes}});
    return Kernel(c.device, "intersect_packets", constants);
  };
  nearest_ = make(false);
  if (c.plan.shadows) any_ = make(true);

  // A quarter of the budget: two levels of pairs, what they entered, and the cells that begin them.
  constexpr std::uint64_t pair_bytes = 2 * 8 + 4 + (gpu::FRUSTUM_WORDS * 4 + 8) / pairs_a_cell;
  const std::uint64_t budget = (c.settings.memory_mib << 20U) / 4;
  const std::uint64_t room = std::min<std::uint64_t>(c.device.limits().storage_range / 16, most_room);
  pair_room_ = rounded(std::clamp<std::uint64_t>(budget / pair_bytes, least_room, room));
  cell_room_ = pair_room_ / pairs_a_cell;
  pairs_ = Buffer(c.device, "pairs", std::uint64_t{pair_room_} * 8 * 2);
  entered_ = Buffer(c.device, "entered children", std::uint64_t{pair_room_} * 4);
  block_sums_ = Buffer(c.device, "block sums", (std::uint64_t{pair_room_} / gpu::SCAN_BLOCK + 1) * 4);
  frustums_ = Buffer(c.device, "frustums", std::uint64_t{cell_room_} * gpu::FRUSTUM_WORDS * 4, Buffer::Kind::device,
                     vk::BufferUsageFlagBits::eShaderDeviceAddress);
  lists_ = Buffer(c.device, "lists of leaves", std::uint64_t{cell_room_} * 8);
  packets_ = Buffer(c.device, "packets", (std::uint64_t{c.memory.capacity} + 1) * 8);
  pair_levels_ = Buffer(c.device, "pairs a level", level_room * 4);
  counters_readback_ = Buffer(c.device, "counters", gpu::COUNT_WORDS * 4, Buffer::Kind::readback);
  levels_readback_ = Buffer(c.device, "pairs a level", level_room * 4, Buffer::Kind::readback);
  packet_readback_ = Buffer(c.device, "packet", 16, Buffer::Kind::readback);
}

glm::uvec2 CellWalk::frustums_at() const {
  const std::uint64_t address = frustums_.address();
  return {static_cast<std::uint32_t>(address), static_cast<std::uint32_t>(address >> 32U)};
}

void CellWalk::bind(Recorder& recorder) const {
  recorder.bind(ROLE_PAIRS, pairs_);
  recorder.bind(ROLE_SURVIVORS, entered_);
  recorder.bind(ROLE_LISTS, lists_);
  recorder.bind(ROLE_PACKETS, packets_);
  recorder.bind(ROLE_PAIR_LEVELS, pair_levels_);
}

// One level from one half of the pairs' buffer into the other.
void CellWalk::open_level(Recorder& recorder, std::uint32_t kind, std::uint32_t level) {
  const std::uint32_t half_read = level % 2;
  const struct {
    glm::uvec2 frustums;
    std::uint32_t kind, half_read, room, level, ray_level;
  } push{frustums_at(), kind, half_read, pair_room_, level, ray_level};
  recorder.dispatch_indirect(open_, push, gpu::ARGS_PAIRS);
  compact_.record(recorder, {half_read, pair_room_}, gpu::ARGS_PAIR_BLOCKS, gpu::ARGS_PAIR_SCATTER);
}

void CellWalk::intersect(Recorder& recorder, std::uint32_t kind, std::uint32_t level) {
  recorder.stage("intersect");
  recorder.dispatch_indirect(ranges_, pair_room_, gpu::ARGS_PAIR_RANGES);
  const struct { std::uint32_t kind, room, level; } push{kind, pair_room_, level};
  recorder.dispatch_indirect(kind == gpu::KIND_SHADOW ? any_ : nearest_, push, gpu::ARGS_WALK_CELLS);
}

// False where the pairs had no room: then nothing was intersected.
bool CellWalk::attempt(Recorder& recorder, std::uint32_t kind, CellRange cells, const std::function<void()>& begin) {
  const std::uint32_t levels = context_.scene.hierarchy_levels();
  const struct { std::uint32_t first, most, room; } push{cells.first, cells.most, cell_room_};
  recorder.stage("rays_hierarchy");
  recorder.dispatch(begin_, push, 1);
  begin();
  recorder.bind(ROLE_BLOCK_SUMS, block_sums_);
  recorder.stage("traverse");  // with its compaction: a stage a level would cost more than what it tells
  for (std::uint32_t level = 0; level < levels; ++level) open_level(recorder, kind, level);
  recorder.bind(ROLE_BLOCK_SUMS, context_.memory.block_sums);
  intersect(recorder, kind, levels);
  recorder.copy(context_.memory.counters, counters_readback_, gpu::COUNT_WORDS * 4);
  recorder.copy(pair_levels_, levels_readback_, pair_levels_.bytes());
  recorder.submit_and_wait();
  return counters_readback_.view<std::uint32_t>()[gpu::COUNT_WALK_OVERFLOW] == 0;
}

void CellWalk::trace_singly(Recorder& recorder, std::uint32_t kind, std::uint32_t packet) {
  recorder.copy(packets_, packet_readback_, 12, std::uint64_t{packet} * 8);
  recorder.submit_and_wait();
  const auto ends = packet_readback_.view<std::uint32_t>();
  const struct { std::uint32_t kind, first, rays; } push{kind, ends[0], ends[2] - ends[0]};
  recorder.stage("traverse");
  recorder.dispatch(kind == gpu::KIND_SHADOW ? single_.any : single_.nearest, push,
                    (push.rays + gpu::GROUP - 1) / gpu::GROUP);
}

void CellWalk::trace(Recorder& recorder, std::uint32_t kind, const std::function<void()>& begin) {
  bind(recorder);
  recorder.fill(pair_levels_, 0);
  if (!attempt(recorder, kind, {}, begin)) {
    const std::uint32_t cells = counters_readback_.view<std::uint32_t>()[gpu::COUNT_CELLS];
    std::uint32_t batch = std::max(std::min(cells, cell_room_) / 2, 1U);
    for (std::uint32_t at = 0; at < cells;) {
      const std::uint32_t count = std::min(batch, cells - at);
      if (attempt(recorder, kind, {at, count}, begin)) {
        at += count;
      } else if (count > 1) {
        batch = count / 2;
      } else {
        trace_singly(recorder, kind, at++);
      }
    }
  }
  pairs_per_level_.clear();  // also those of walks that were repeated: they were tested
  for (const auto pairs : levels_readback_.view<std::uint32_t>())
    if (pairs != 0) pairs_per_level_.push_back(pairs);
}

}  // namespace sheaf
