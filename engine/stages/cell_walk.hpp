// SPDX-License-Identifier: MIT
// The walk that `frustum` and `classify` share: pairs of a cell (a packet of rays, or a class of them) and a node of
// the object hierarchy, level by level from the root, opened and compacted on the device until only leaves are left;
// then every packet's rays through its cell's leaves. The host waits once a walk. Memory is bounded: a walk whose pairs
// have no room is repeated in parts, and a part that cannot be cut further goes through the hierarchy ray by ray. No
// pair is ever dropped.
#pragma once

#include <functional>

#include "stages/scan.hpp"
#include "stages/traverse_single.hpp"

namespace sheaf {

struct WalkRange {  // of a list's packets, or of its rays
  std::uint32_t first = 0, most = 0xFFFFFFFFU;
};

struct OpenStep {
  std::uint32_t half_read = 0;  // of the pairs' buffer; the other is written
  std::uint32_t frustums = 0;   // which set of them
  std::uint32_t level = 0;      // for the stats: of the walk …
  std::uint32_t ray_level = 3;  // … and of the cells, as of nodes over rays (3: BUNDLE rays)
  bool leaves = false;          // pairs with leaves are tested too, where their cell has become smaller
  bool always = false;          // the other half is written also where no pair has a node
};

class CellWalk {
 public:
  /// `frustum_sets`: of a frustum a cell each.
  CellWalk(const TraceContext& context, std::uint32_t frustum_sets);

  /// `record` records a walk of a range, up to and with `intersect`. `units`: the counter of what ranges count.
  void trace(Recorder& recorder, std::uint32_t units, std::uint32_t least, const std::function<void(WalkRange)>& record,
             const std::function<void(WalkRange)>& singly);
  void open(Recorder& recorder, std::uint32_t kind, const OpenStep& step) const;
  void list_pairs(Recorder& recorder) const;
  /// Every packet's rays through the leaves of its cell; `level`: past those opened.
  void intersect(Recorder& recorder, std::uint32_t kind, std::uint32_t level) const;
  void trace_singly(Recorder& recorder, std::uint32_t kind, std::uint32_t first, std::uint32_t rays) const;
  void trace_packet_singly(Recorder& recorder, std::uint32_t kind, std::uint32_t packet) const;

  [[nodiscard]] const Buffer& packets() const { return packets_; }  // first ray and cell of each, and the list's end
  [[nodiscard]] glm::uvec2 frustums_at(std::uint32_t set = 0) const;
  [[nodiscard]] std::uint32_t pair_room() const { return pair_room_; }
  [[nodiscard]] std::uint32_t cell_room() const { return cell_room_; }
  [[nodiscard]] const std::vector<std::uint64_t>& pairs_per_level() const { return pairs_per_level_; }

 private:
  [[nodiscard]] bool attempt(Recorder& recorder, const std::function<void(WalkRange)>& record, WalkRange range) const;

  TraceContext context_;
  std::uint32_t pair_room_ = 0, cell_room_ = 0;
  Kernel open_, ranges_, nearest_, any_;
  Scan compact_;
  SingleKernels single_;
  Buffer pairs_, entered_, block_sums_, frustums_, lists_, packets_, pair_levels_;
  Buffer counters_readback_, levels_readback_, packet_readback_;
  std::vector<std::uint64_t> pairs_per_level_;
};

}  // namespace sheaf
