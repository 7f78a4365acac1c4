// SPDX-License-Identifier: MIT
// Strategies `rsh` (H: unsorted rays, triangle spheres) and `crsh` (R, C: sorted rays, mesh spheres, then triangle
// spheres; between these, spheres of parts of the meshes): breadth-first traversal of the ray hierarchy with compaction
// after every level (R 4.4), then local intersection (R 4.5). Memory is bounded: a level whose candidates do not fit is
// cut into batches, each walked to the rays before the next. No pair is ever dropped.
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
  struct Step {  // one level's nodes against one kind of objects
    std::uint32_t level = 0;
    const Buffer* spheres = nullptr;
    bool opens_parts = false;  // of the step before; else its nodes
  };
  struct Walk {  // one list's traversal
    std::uint32_t kind = 0;
    std::vector<HierarchyLevel> levels;
    std::vector<Step> steps;
    std::vector<glm::uvec2>* survivors = nullptr;  // of the last step: collected here instead of intersected
    [[nodiscard]] std::uint32_t top() const { return static_cast<std::uint32_t>(levels.size() - 1); }
    void step_down(std::uint32_t from, std::uint32_t to, const Buffer& spheres);
  };
  struct Runs {                   // of triangles
    std::vector<glm::uvec2> all;  // first, how many
    Buffer table, spheres;
    void upload(const Device& device, const std::string& name);
  };
  struct Seeds {
    std::vector<PairSeed> all;
    std::uint64_t candidates = 0;
    void add(std::uint32_t node, std::uint32_t first_object, std::uint32_t objects);
  };
  void cut_meshes();
  void record_spheres(Recorder& recorder, const Runs& runs) const;
  void walk_seeds(Recorder& recorder, const Walk& walk, const Seeds& seeds);
  void walk_parents(Recorder& recorder, const Walk& walk, std::size_t step, std::uint32_t parents);
  void test(Recorder& recorder, const Walk& walk, std::size_t step, std::uint32_t candidates, std::uint32_t offset,
            std::uint32_t seeds);
  void descend(Recorder& recorder, const Walk& walk, std::size_t step);
  void reset_hits(Recorder& recorder, std::uint32_t kind);
  [[nodiscard]] std::uint32_t read_counter(Recorder& recorder, std::uint32_t counter);
  [[nodiscard]] Seeds begin_at_triangles(Walk& walk) const;
  [[nodiscard]] Seeds begin_at_meshes(Recorder& recorder, Walk& walk, std::uint32_t rays);

  TraceContext context_;
  std::uint32_t capacity_;  // candidates of a batch
  SortRays sort_;
  RaysHierarchy hierarchy_;
  Kernel spheres_, test_, nearest_, any_;
  Scan compact_;
  Runs meshes_, parts_;                    // crsh: instances, and what they are cut into
  std::vector<glm::uvec2> parts_of_mesh_;  // first part, how many
  Buffer triangle_spheres_, candidates_, flags_, seeds_, block_sums_, counter_readback_, collected_;
  std::vector<Buffer> survivors_;     // a step
  std::vector<std::uint64_t> pairs_;  // tested by the last trace, a level
};

}  // namespace sheaf
