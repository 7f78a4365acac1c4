// SPDX-License-Identifier: MIT
// Strategies `rsh` (H: unsorted rays, triangle spheres) and `crsh` (R, C: sorted rays, mesh spheres, then triangle
// spheres): breadth-first traversal of the ray hierarchy with compaction after every level (R 4.4), then local
// intersection (R 4.5). Memory is bounded: a level whose candidates do not fit is cut into batches, each walked to the
// rays before the next. No pair is ever dropped.
#pragma once

#include "stages/rays_hierarchy.hpp"
#include "stages/sort.hpp"

namespace sheaf {

struct PairSeed {  // a node against a run of objects
  std::uint32_t node = 0, first_object = 0;
  std::uint32_t before = 0;  // candidates of the seeds before it
  std::uint32_t unused = 0;
};

class TraversePairs final : public Tracer {
 public:
  explicit TraversePairs(const TraceContext& context);
  void objects_moved(Recorder& recorder, const Motion& motion) override;
  void trace(Recorder& recorder, const RayList& list, std::uint32_t kind, std::uint32_t generation) override;
  [[nodiscard]] std::vector<std::uint64_t> pairs_per_level() const override { return {pairs_.rbegin(), pairs_.rend()}; }

 private:
  struct Walk {  // one list's traversal
    std::uint32_t kind = 0;
    std::vector<HierarchyLevel> levels;
    std::uint32_t bottom = 0;                      // level whose survivors are wanted
    std::vector<glm::uvec2>* survivors = nullptr;  // collected here instead of intersected
  };
  void walk_seeds(Recorder& recorder, const Walk& walk, std::uint32_t level, std::vector<PairSeed> seeds,
                  std::uint64_t candidates);
  void walk_parents(Recorder& recorder, const Walk& walk, std::uint32_t level, std::uint32_t parents);
  void test(Recorder& recorder, const Walk& walk, std::uint32_t level, std::uint32_t candidates, std::uint32_t offset,
            std::uint32_t seeds);
  void descend(Recorder& recorder, const Walk& walk, std::uint32_t level);
  void reset_hits(Recorder& recorder, std::uint32_t kind);
  [[nodiscard]] std::uint32_t read_counter(Recorder& recorder, std::uint32_t counter);
  [[nodiscard]] std::vector<PairSeed> mesh_seeds(Recorder& recorder, Walk walk, std::uint32_t top, std::uint32_t& level,
                                                 std::uint64_t& candidates);

  TraceContext context_;
  std::uint32_t capacity_;  // candidates of a batch
  SortRays sort_;
  RaysHierarchy hierarchy_;
  Kernel spheres_, test_, nearest_, any_;
  Scan compact_;
  Buffer triangle_spheres_, mesh_spheres_, candidates_, flags_, seeds_, block_sums_, counter_readback_, collected_;
  std::vector<Buffer> survivors_;     // a level
  std::vector<std::uint64_t> pairs_;  // tested by the last trace, a level
};

}  // namespace sheaf
