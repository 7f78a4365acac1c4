// SPDX-License-Identifier: MIT
// Strategy `frustum` (S, R 3.4): rays sorted, the sorted order cut into packets, a frustum a packet, breadth-first
// through the object hierarchy, then local intersection.
//
// A packet ends where the dominant axis of the rays or its sign changes, so that every packet has a frustum; where the
// leading bits of the hash change; and after BUNDLE rays.
#pragma once

#include "stages/cell_walk.hpp"
#include "stages/sort.hpp"

namespace sheaf {

class TraverseFrustums final : public Tracer {
 public:
  explicit TraverseFrustums(const TraceContext& context);
  void trace(Recorder& recorder, const RayList& list, std::uint32_t kind, std::uint32_t generation) override;
  [[nodiscard]] std::vector<std::uint64_t> pairs_per_level() const override { return walk_.pairs_per_level(); }

 private:
  void record_walk(Recorder& recorder, std::uint32_t kind, WalkRange packets);
  void cut_packets(Recorder& recorder, std::uint32_t kind, bool sorted);

  TraceContext context_;
  SortRays sort_;
  Kernel keys_kernel_, begin_, frustums_;
  Scan packets_;
  CellWalk walk_;
  Buffer packet_keys_;
};

}  // namespace sheaf
