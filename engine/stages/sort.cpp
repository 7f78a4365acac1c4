// SPDX-License-Identifier: MIT
#include "stages/sort.hpp"

#include <algorithm>
#include <bit>

#include "interface/push/lists.h"

namespace sheaf {

void record_bounds(Recorder& recorder, const Kernel& kernel, std::uint32_t kind, std::uint32_t args) {
  gpu::BoundsPush push{kind, 1};
  recorder.dispatch(kernel, push, 1);
  push.reset = 0;
  recorder.dispatch_indirect(kernel, push, args);
}

KeyLayout key_layout(std::uint32_t kind, std::uint32_t lights, std::uint64_t rays) {
  const auto log2 = static_cast<std::uint32_t>(std::bit_width(std::max<std::uint64_t>(rays, 1)));
  KeyLayout layout;
  if (kind == gpu::KIND_SHADOW) {
    layout.light_bits = std::min<std::uint32_t>(static_cast<std::uint32_t>(std::bit_width(lights - 1)), 12);
    layout.coordinates = 2;
    layout.coordinate_bits = std::clamp((log2 + 1) / 2, 4U, std::min(10U, (32 - layout.light_bits) / 2));
  } else {
    layout.coordinates = 5;
    layout.coordinate_bits = 4;
  }
  return layout;
}

SortRays::SortRays(const TraceContext& context) {
  const Device& device = context.device;
  const SpecConstant group{SPEC_GROUP, gpu::SCAN_GROUP};
  auto run_kernel = [&](const char* stem) { return Kernel(device, stem, {&group, 1}); };
  bounds_ = run_kernel("hash_bounds");
  hash_ = Kernel(device, "hash");
  sizes_ = run_kernel("compress_sizes");
  count_ = run_kernel("sort_count");
  spine_ = run_kernel("sort_spine");
  scatter_ = run_kernel("sort_scatter");
  fill_ = run_kernel("decompress_fill");
  compress_ = Scan(device, "compress");
  starts_ = Scan(device, "starts");
  segmented_ = Scan(device, "segmented");
}

bool SortRays::record_passes(Recorder& recorder, const RayMemory& memory, std::uint32_t key_bits) const {
  recorder.bind(ROLE_BLOCK_SUMS, memory.digits);
  bool in_alt = false;
  for (std::uint32_t shift = 0; shift < key_bits; shift += gpu::RADIX_BITS, in_alt = !in_alt) {
    recorder.bind(ROLE_CHUNKS, in_alt ? memory.chunks_alt : memory.chunks);
    recorder.bind(ROLE_CHUNKS_ALT, in_alt ? memory.chunks : memory.chunks_alt);
    const gpu::SortPush push{shift};
    recorder.dispatch_indirect(count_, push, gpu::ARGS_CHUNKS);
    recorder.dispatch_indirect(spine_, push, gpu::ARGS_ONE);
    recorder.dispatch_indirect(scatter_, push, gpu::ARGS_CHUNKS);
  }
  recorder.bind(ROLE_CHUNKS, in_alt ? memory.chunks_alt : memory.chunks);
  recorder.bind(ROLE_BLOCK_SUMS, memory.block_sums);
  return in_alt;
}

void SortRays::record_keys(Recorder& recorder, const TraceContext& context, std::uint32_t kind) const {
  const KeyLayout layout = key_layout(kind, context.scene.lights(), context.memory.tile_pixels);
  recorder.stage("hash");
  recorder.bind(ROLE_KEYS, context.memory.keys);
  const gpu::HashPush key{kind, layout.coordinate_bits, layout.light_bits};
  recorder.dispatch_indirect(hash_, key, gpu::ARGS_RAYS);
}

void SortRays::record(Recorder& recorder, const TraceContext& context, std::uint32_t kind) const {
  const RayMemory& memory = context.memory;
  recorder.stage("hash");
  record_bounds(recorder, bounds_, kind, gpu::ARGS_BLOCKS);
  record_keys(recorder, context, kind);
  record_order(recorder, context, kind, key_layout(kind, context.scene.lights(), memory.tile_pixels).bits());
}

void SortRays::record_order(Recorder& recorder, const TraceContext& context, std::uint32_t kind,
                            std::uint32_t key_bits) const {
  const RayMemory& memory = context.memory;
  recorder.bind(ROLE_KEYS, memory.keys);
  recorder.bind(ROLE_CHUNKS, memory.chunks);
  recorder.bind(ROLE_SKELETON, memory.skeleton);
  recorder.bind(ROLE_ORDER_KEPT, memory.order_kept);
  recorder.stage("compress");
  const gpu::KindPush push{kind};
  compress_.record(recorder, push, gpu::ARGS_BLOCKS);
  recorder.dispatch_indirect(sizes_, push, gpu::ARGS_CHUNKS);

  recorder.stage("sort");
  (void)record_passes(recorder, memory, key_bits);

  recorder.stage("decompress");
  recorder.dispatch_indirect(fill_, push, gpu::ARGS_BLOCKS);
  starts_.record(recorder, push, gpu::ARGS_CHUNKS);
  segmented_.record(recorder, push, gpu::ARGS_BLOCKS);
}

}  // namespace sheaf
