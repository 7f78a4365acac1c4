// SPDX-License-Identifier: MIT
// Hash, compress, sort, decompress (R 4.2, S): brings a list's order into ray space. A plan without it keeps
// the order of the pixels (`Plan::sorts`).
#pragma once

#include "stages/scan.hpp"
#include "stages/tracer.hpp"

namespace sheaf {

struct KeyLayout {
  std::uint32_t coordinates = 0, coordinate_bits = 0, light_bits = 0;
  [[nodiscard]] std::uint32_t bits() const { return coordinates * coordinate_bits + light_bits; }
};

/// Shadow rays: as many bits as leave about 16 rays per cell if a batch of `rays` fills half of them; fewer bits are
/// fewer passes. Others: four a coordinate. With six the hierarchy's tests fall by another 1 %, with two they rise by 3
/// to 7 %.
[[nodiscard]] KeyLayout key_layout(std::uint32_t kind, std::uint32_t lights, std::uint64_t rays);

/// Bounds of a list's rays, over which keys are laid: `kernel` first resets them.
void record_bounds(Recorder& recorder, const Kernel& kernel, std::uint32_t kind, std::uint32_t args);

class SortRays {
 public:
  SortRays() = default;
  explicit SortRays(const TraceContext& context);
  void record(Recorder& recorder, const TraceContext& context, std::uint32_t kind) const;
  /// The keys of a list as it now stands, after `record`.
  void record_keys(Recorder& recorder, const TraceContext& context, std::uint32_t kind) const;
  /// Brings the list into the order of memory.keys, of `key_bits` each.
  void record_order(Recorder& recorder, const TraceContext& context, std::uint32_t kind, std::uint32_t key_bits) const;
  /// The passes alone, over counters[COUNT_CHUNKS] chunks (also for tests). True where the result is in chunks_alt.
  [[nodiscard]] bool record_passes(Recorder& recorder, const RayMemory& memory, std::uint32_t key_bits) const;

 private:
  Kernel bounds_, hash_, sizes_, count_, spine_, scatter_, fill_;
  Scan compress_, starts_, segmented_;
};

}  // namespace sheaf
