// SPDX-License-Identifier: MIT
// The walk that `frustum` and `classify` share: pairs of a cell (a packet of rays, or a class of them) and a node of
// the object hierarchy, level by level from the root, opened and compacted on the device until only leaves are left;
// then every packet's rays through its cell's leaves. The host waits once a walk. Memory is bounded: a walk whose pairs
// have no room is repeated with fewer cells, and a packet that alone has too many goes through the hierarchy ray by
// ray. No pair is ever dropped.
#pragma once

#include <functional>

#include "stages/scan.hpp"
#include "stages/traverse_single.hpp"

namespace sheaf {

struct CellRange {
  std::uint32_t first = 0, most = 0xFFFFFFFFU;
};

class CellWalk {
 public:
  explicit CellWalk(const TraceContext& context);

  /// `begin` records what makes the frustums and first pairs of the cells at work (counters COUNT_WALK_…).
  void trace(Recorder& recorder, std::uint32_t kind, const std::function<void()>& begin);

  [[nodiscard]] const Buffer& packets() const { return packets_; }  // first ray and cell of each, and the list's end
  [[nodiscard]] glm::uvec2 frustums_at() const;
  [[nodiscard]] const std::vector<std::uint64_t>& pairs_per_level() const { return pairs_per_level_; }

 private:
  [[nodiscard]] bool attempt(Recorder& recorder, std::uint32_t kind, CellRange cells,
                             const std::function<void()>& begin);
  void open_level(Recorder& recorder, std::uint32_t kind, std::uint32_t level);
  void intersect(Recorder& recorder, std::uint32_t kind, std::uint32_t level);
  void trace_singly(Recorder& recorder, std::uint32_t kind, std::uint32_t packet);
  void bind(Recorder& recorder) const;

  TraceContext context_;
  std::uint32_t pair_room_ = 0, cell_room_ = 0;
  Kernel begin_, open_, ranges_, nearest_, any_;
  Scan compact_;
  SingleKernels single_;
  Buffer pairs_, entered_, block_sums_, frustums_, lists_, packets_, pair_levels_;
  Buffer counters_readback_, levels_readback_, packet_readback_;
  std::vector<std::uint64_t> pairs_per_level_;
};

}  // namespace sheaf
