// SPDX-License-Identifier: MIT
// Strategy `classify` (Arvo, Kirk 1987, R 3.1; Simiakakis, Day 1994, R 3.2): rays sorted into cells of their
// five-dimensional space, halved only where there are rays; a cell's candidates are nodes of the object hierarchy,
// taken over from the cell above and made anew after five halvings, until they are leaves.
//
// A cell stops being divided at a few leaves, or at CLASS_RAYS rays with few candidates for its depth. Classes need an
// order: --sort has no say.
#pragma once

#include "stages/cell_walk.hpp"
#include "stages/sort.hpp"

namespace sheaf {

class TraverseClasses final : public Tracer {
 public:
  static constexpr std::uint32_t key_bits = gpu::CLASS_HALVINGS + 3;  // face, then halves

  explicit TraverseClasses(const TraceContext& context);
  void trace(Recorder& recorder, const RayList& list, std::uint32_t kind, std::uint32_t generation) override;
  [[nodiscard]] std::vector<std::uint64_t> pairs_per_level() const override { return walk_.pairs_per_level(); }

 private:
  struct Progress {  // of a walk
    std::uint32_t half = 0, opened = 0, round = 0;
  };
  void sort(Recorder& recorder, std::uint32_t kind);
  void record_walk(Recorder& recorder, std::uint32_t kind, WalkRange rays);
  void divide(Recorder& recorder, std::uint32_t round);
  void make_candidates(Recorder& recorder, bool root, Progress& progress);
  void open(Recorder& recorder, std::uint32_t kind, OpenStep step, Progress& progress);

  TraceContext context_;
  SortRays sort_;
  Kernel bounds_, keys_, cuts_, begin_, frustums_, stops_, candidates_;
  Scan divide_, offsets_, packets_;
  CellWalk walk_;
  Buffer class_bounds_, ray_cells_, cells_, cells_next_, cell_stops_, cell_offsets_;
};

}  // namespace sheaf
