// SPDX-License-Identifier: MIT
#include "stages/cell_walk.hpp"

#include <algorithm>

#include "interface/push/cells.h"
#include "interface/push/trace.h"

namespace sheaf {
namespace {

constexpr std::uint32_t least_room = 4096, most_room = 1U << 22U;  // pairs
constexpr std::uint32_t pairs_a_cell = 8;                          // that there is room for, all cells at work
constexpr std::uint32_t level_room = gpu::STACK_SIZE + 1;          // of the object hierarchy, and its leaves

std::uint32_t rounded(std::uint64_t items) {
  return static_cast<std::uint32_t>(items / gpu::SCAN_BLOCK * gpu::SCAN_BLOCK);
}

}  // namespace

CellWalk::CellWalk(const TraceContext& c, std::uint32_t frustum_sets)
    : context_(c), ranges_(c.device, "pairs_ranges"), compact_(c.device, "open"), single_(c, false) {
  const std::vector<SpecConstant> counting{{SPEC_COUNTED, c.counted}};
  open_ = Kernel(c.device, "pairs_open", counting);
  const auto lanes = lane_constants(c.device, gpu::BUNDLE);
  auto make = [&](bool any_hit) {
    auto constants = candidate_constants(c, any_hit);
    constants.insert(constants.end(), lanes.begin(), lanes.end());
    return Kernel(c.device, "intersect_packets", constants);
  };
  nearest_ = make(false);
  if (c.plan.shadows) any_ = make(true);

  // What the rays leave of the budget: two levels of pairs, what they entered, and the cells that begin them.
  const std::uint64_t cell_bytes =
      frustum_sets * gpu::FRUSTUM_WORDS * 4 + 8 + 8 * 2 + 4 * 2;  // also list, cell twice, state
  const std::uint64_t pair_bytes = 2 * 8 + 4 + cell_bytes / pairs_a_cell;
  const std::uint64_t budget = walk_budget(c.settings);
  const std::uint64_t room = std::min<std::uint64_t>(c.device.limits().storage_range / 16, most_room);
  pair_room_ = rounded(std::clamp<std::uint64_t>(budget / pair_bytes, least_room, room));
  cell_room_ = std::min(pair_room_ / pairs_a_cell, c.memory.capacity + 1);
  pairs_ = Buffer(c.device, "pairs", std::uint64_t{pair_room_} * 8 * 2);
  entered_ = Buffer(c.device, "entered children", std::uint64_t{pair_room_} * 4);
  block_sums_ = Buffer(c.device, "block sums", (std::uint64_t{pair_room_} / gpu::SCAN_BLOCK + 1) * 4);
  frustums_ = Buffer(c.device, "frustums", frustum_sets * std::uint64_t{cell_room_} * gpu::FRUSTUM_WORDS * 4,
                     Buffer::Kind::device, vk::BufferUsageFlagBits::eShaderDeviceAddress);
  lists_ = Buffer(c.device, "lists of leaves", std::uint64_t{cell_room_} * 8);
  packets_ = Buffer(c.device, "packets", (std::uint64_t{c.memory.capacity} + 1) * 8);
  pair_levels_ = Buffer(c.device, "pairs a level", level_room * 4);
  counters_readback_ = Buffer(c.device, "counters", gpu::COUNT_WORDS * 4, Buffer::Kind::readback);
  levels_readback_ = Buffer(c.device, "pairs a level", level_room * 4, Buffer::Kind::readback);
  packet_readback_ = Buffer(c.device, "packet", 16, Buffer::Kind::readback);
}

glm::uvec2 CellWalk::frustums_at(std::uint32_t set) const {
  return frustums_.address_words(set * std::uint64_t{cell_room_} * gpu::FRUSTUM_WORDS * 4);
}

// One level from one half of the pairs' buffer into the other.
void CellWalk::open(Recorder& recorder, std::uint32_t kind, const OpenStep& step) const {
  const gpu::PairsOpenPush push{
      frustums_at(step.frustums), kind, step.half_read, pair_room_, step.level, step.ray_level, step.leaves ? 1U : 0U};
  recorder.dispatch_indirect(open_, push, gpu::ARGS_PAIRS);
  recorder.bind(ROLE_BLOCK_SUMS, block_sums_);
  compact_.record(recorder, gpu::OpenScanPush{step.half_read, pair_room_, step.always ? 1U : 0U}, gpu::ARGS_PAIR_BLOCKS,
                  gpu::ARGS_PAIR_SCATTER);
  recorder.bind(ROLE_BLOCK_SUMS, context_.memory.block_sums);
}

void CellWalk::list_pairs(Recorder& recorder) const {
  recorder.fill(lists_, 0);
  recorder.dispatch_indirect(ranges_, gpu::PairsRangesPush{pair_room_}, gpu::ARGS_PAIR_RANGES);
}

void CellWalk::intersect(Recorder& recorder, std::uint32_t kind, std::uint32_t level) const {
  recorder.stage("intersect");
  list_pairs(recorder);
  const gpu::IntersectPacketsPush push{kind, pair_room_, level};
  recorder.dispatch_indirect(kind == gpu::KIND_SHADOW ? any_ : nearest_, push, gpu::ARGS_WALK_CELLS);
}

void CellWalk::trace_singly(Recorder& recorder, std::uint32_t kind, std::uint32_t first, std::uint32_t rays) const {
  const gpu::TraverseSinglePush push{kind, first, rays};
  recorder.stage("traverse");
  recorder.dispatch(kind == gpu::KIND_SHADOW ? single_.any : single_.nearest, push,
                    (rays + gpu::GROUP - 1) / gpu::GROUP);
}

void CellWalk::trace_packet_singly(Recorder& recorder, std::uint32_t kind, std::uint32_t packet) const {
  recorder.copy(packets_, packet_readback_, 12, std::uint64_t{packet} * 8);
  recorder.submit_and_wait();
  const auto ends = packet_readback_.view<std::uint32_t>();
  trace_singly(recorder, kind, ends[0], ends[2] - ends[0]);
}

// False where the pairs had no room: then nothing was intersected.
bool CellWalk::attempt(Recorder& recorder, const std::function<void(WalkRange)>& record, WalkRange range) const {
  recorder.stage("rays_hierarchy");
  record(range);
  recorder.copy(context_.memory.counters, counters_readback_, gpu::COUNT_WORDS * 4);
  recorder.copy(pair_levels_, levels_readback_, pair_levels_.bytes());
  recorder.submit_and_wait();
  return counters_readback_.view<std::uint32_t>()[gpu::COUNT_WALK_OVERFLOW] == 0;
}

void CellWalk::trace(Recorder& recorder, std::uint32_t units, std::uint32_t least,
                     const std::function<void(WalkRange)>& record, const std::function<void(WalkRange)>& singly) {
  recorder.bind(ROLE_PAIRS, pairs_);
  recorder.bind(ROLE_SURVIVORS, entered_);
  recorder.bind(ROLE_LISTS, lists_);
  recorder.bind(ROLE_PACKETS, packets_);
  recorder.bind(ROLE_PAIR_LEVELS, pair_levels_);
  recorder.fill(pair_levels_, 0);
  if (!attempt(recorder, record, {})) {
    const std::uint32_t all = counters_readback_.view<std::uint32_t>()[units];
    std::uint32_t batch = std::max(all / 2, least);
    for (std::uint32_t at = 0; at < all;) {
      const WalkRange range{at, std::min(batch, all - at)};
      const bool fits = attempt(recorder, record, range);
      if (!fits && range.most > least) {
        batch = std::max(range.most / 2, least);
        continue;
      }
      if (!fits) singly(range);
      at += range.most;
      batch = fits ? std::min(2 * batch, all) : batch;  // a crowded part does not slow what follows
    }
  }
  pairs_per_level_.clear();  // also those of walks that were repeated: they were tested
  for (const auto pairs : levels_readback_.view<std::uint32_t>())
    if (pairs != 0) pairs_per_level_.push_back(pairs);
}

}  // namespace sheaf
