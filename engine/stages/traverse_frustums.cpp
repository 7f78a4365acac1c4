// SPDX-License-Identifier: MIT
#include "stages/traverse_frustums.hpp"

#include <algorithm>
#include <bit>

#include "interface/push/cells.h"

namespace sheaf {
namespace {

// Leading bits of the hash that the rays of a packet share: about BUNDLE rays per cell if a batch filled half of them.
std::uint32_t shared_bits(std::uint64_t rays) {
  const auto log2 = static_cast<std::uint32_t>(std::bit_width(rays));
  return std::max(log2, 6U) - 5;
}

}  // namespace

TraverseFrustums::TraverseFrustums(const TraceContext& c)
    : context_(c),
      keys_kernel_(c.device, "packets_keys"),
      begin_(c.device, "walk_begin"),
      frustums_(c.device, "packets_frustums"),
      packets_(c.device, "packets"),
      walk_(c, 1),
      packet_keys_(c.device, "packet keys", std::uint64_t{c.memory.capacity} * 4) {
  if (c.plan.sorts) sort_ = SortRays(c);
}

void TraverseFrustums::cut_packets(Recorder& recorder, std::uint32_t kind, bool sorted) {
  if (sorted) sort_.record_keys(recorder, context_, kind);
  recorder.stage("rays_hierarchy");
  recorder.bind(ROLE_PACKET_KEYS, packet_keys_);
  recorder.bind(ROLE_PACKETS, walk_.packets());
  const std::uint64_t rays = context_.memory.tile_pixels;
  const std::uint32_t bits = key_layout(kind, context_.scene.lights(), rays).bits();
  const gpu::PacketsKeysPush push{kind, sorted ? bits - std::min(bits, shared_bits(rays)) : 32};
  recorder.dispatch_indirect(keys_kernel_, push, gpu::ARGS_RAYS);
  packets_.record(recorder, gpu::KindPush{kind}, gpu::ARGS_BLOCKS);
}

void TraverseFrustums::record_walk(Recorder& recorder, std::uint32_t kind, WalkRange packets) {
  const gpu::WalkBeginPush begin{packets.first, packets.most, walk_.cell_room()};
  recorder.dispatch(begin_, begin, 1);
  recorder.dispatch_indirect(frustums_, gpu::PacketsFrustumsPush{walk_.frustums_at()}, gpu::ARGS_WALK_RUNS);
  recorder.stage("traverse");  // with its compaction: a stage a level would cost more than what it tells
  const std::uint32_t levels = context_.scene.hierarchy_levels();
  for (std::uint32_t level = 0; level < levels; ++level)
    walk_.open(recorder, kind, {.half_read = level % 2, .level = level});
  walk_.intersect(recorder, kind, levels);
}

void TraverseFrustums::trace(Recorder& recorder, const RayList& list, std::uint32_t kind, std::uint32_t) {
  list.bind(recorder);
  const bool sorted = context_.plan.sorts && kind != gpu::KIND_PRIMARY;
  if (sorted) sort_.record(recorder, context_, kind);
  cut_packets(recorder, kind, sorted);
  walk_.trace(
      recorder, gpu::COUNT_CELLS, 1, [&](WalkRange packets) { record_walk(recorder, kind, packets); },
      [&](WalkRange packets) { walk_.trace_packet_singly(recorder, kind, packets.first); });
}

}  // namespace sheaf
