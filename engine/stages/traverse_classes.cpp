// SPDX-License-Identifier: MIT
#include "stages/traverse_classes.hpp"

#include <algorithm>

#include "interface/push/cells.h"

namespace sheaf {
namespace {

constexpr std::uint32_t halvings = 5;  // between two makings of the candidates (R 3.1)
constexpr std::uint32_t rounds = gpu::CLASS_HALVINGS / halvings;
// Of the object hierarchy. More, and cells that are still wide meet most of it; none, and nothing is shared.
constexpr std::uint32_t levels_a_round = 1;
// Candidates a level that a cell of few rays may have and stay whole. Measured against 2, 6 and 12, and against cells
// of 64 rays staying whole in any case: a city of a million triangles 1.3 s a frame against 1.4, 5, 9 and 124; spheres,
// crowd and Sponza within 30 %.
constexpr std::uint32_t many_a_level = 3;
constexpr std::uint32_t finest_level = 3;  // as of nodes over BUNDLE rays

}  // namespace

TraverseClasses::TraverseClasses(const TraceContext& c)
    : context_(c),
      sort_(c),
      keys_(c.device, "classify_keys"),
      cuts_(c.device, "classify_cuts"),
      begin_(c.device, "classify_begin"),
      stops_(c.device, "classify_stops"),
      candidates_(c.device, "classify_candidates"),
      divide_(c.device, "divide"),
      offsets_(c.device, "candidates"),
      packets_(c.device, "class_packets"),
      walk_(c, 2) {
  const auto lanes = lane_constants(c.device, gpu::BUNDLE);
  bounds_ = Kernel(c.device, "classify_bounds", lanes);
  frustums_ = Kernel(c.device, "classify_frustums", lanes);
  const std::uint64_t cells = std::uint64_t{walk_.cell_room()} + 1;
  class_bounds_ = Buffer(c.device, "class bounds", 6 * 10 * 4);
  ray_cells_ = Buffer(c.device, "cells of rays", std::uint64_t{c.memory.capacity} * 4);
  cells_ = Buffer(c.device, "cells", cells * 8);
  cells_next_ = Buffer(c.device, "cells", cells * 8);
  cell_stops_ = Buffer(c.device, "cells that stop", cells * 4);
  cell_offsets_ = Buffer(c.device, "candidates before a cell", cells * 4);
}

void TraverseClasses::sort(Recorder& recorder, std::uint32_t kind) {
  recorder.bind(ROLE_CLASS_BOUNDS, class_bounds_);
  recorder.bind(ROLE_KEYS, context_.memory.keys);
  recorder.stage("hash");
  record_bounds(recorder, bounds_, kind, gpu::ARGS_RAYS);
  gpu::ClassifyKeysPush keys{kind, 0};
  recorder.dispatch_indirect(keys_, keys, gpu::ARGS_RAYS);
  sort_.record_order(recorder, context_, kind, key_bits);
  recorder.stage("hash");
  keys.sorted = 1;
  recorder.dispatch_indirect(keys_, keys, gpu::ARGS_RAYS);
  recorder.bind(ROLE_CELL_CUTS, context_.memory.skeleton);  // that the sort is done with
  recorder.dispatch_indirect(cuts_, gpu::KindPush{kind}, gpu::ARGS_RAYS);
}

// Five halvings: the cells of the next `round`, and their frustums.
void TraverseClasses::divide(Recorder& recorder, std::uint32_t round) {
  const std::uint32_t first = round == 1 ? 1 : 0;
  recorder.bind(ROLE_CELLS, cells_);
  recorder.bind(ROLE_CELLS_NEXT, cells_next_);
  divide_.record(recorder, gpu::DivideScanPush{halvings * round, first, walk_.cell_room()}, gpu::ARGS_WALK_BLOCKS,
                 gpu::ARGS_WALK_SCATTER);
  const gpu::ClassifyFrustumsPush push{walk_.frustums_at(round % 2),
                                       first != 0 ? glm::uvec2(0) : walk_.frustums_at((round + 1) % 2)};
  recorder.dispatch_indirect(frustums_, push, gpu::ARGS_WALK_CELLS);
}

void TraverseClasses::make_candidates(Recorder& recorder, bool root, Progress& progress) {
  const std::uint32_t from_root = root ? 1 : 0, room = walk_.pair_room();
  offsets_.record(recorder, gpu::CandidatesScanPush{progress.half, room, from_root}, gpu::ARGS_CELL_BLOCKS);
  progress.half = 1 - progress.half;
  const gpu::ClassifyCandidatesPush push{room, from_root};
  recorder.dispatch_indirect(candidates_, push, gpu::ARGS_WALK_CELLS);
  std::swap(cells_, cells_next_);
  recorder.bind(ROLE_CELLS, cells_);
}

void TraverseClasses::open(Recorder& recorder, std::uint32_t kind, OpenStep step, Progress& progress) {
  step.half_read = progress.half;
  step.frustums = progress.round % 2;
  step.level = progress.opened++;
  walk_.open(recorder, kind, step);
  progress.half = 1 - progress.half;
}

void TraverseClasses::record_walk(Recorder& recorder, std::uint32_t kind, WalkRange rays) {
  Progress progress;
  recorder.bind(ROLE_CELLS, cells_);
  const gpu::ClassifyBeginPush begin{kind, rays.first, rays.most};
  recorder.dispatch(begin_, begin, 1);
  for (std::uint32_t round = 1; round <= rounds; ++round) {
    recorder.stage("rays_hierarchy");
    progress.round = round;
    divide(recorder, round);
    make_candidates(recorder, round == 1, progress);
    recorder.stage("traverse");
    for (std::uint32_t k = 0; k < levels_a_round; ++k)
      open(recorder, kind, {.ray_level = finest_level + rounds - round, .leaves = k == 0, .always = true}, progress);
    if (round == rounds) break;
    walk_.list_pairs(recorder);
    const gpu::ClassifyStopsPush stop{walk_.pair_room(), many_a_level * progress.opened};
    recorder.dispatch_indirect(stops_, stop, gpu::ARGS_WALK_RUNS);
  }
  while (progress.opened < context_.scene.hierarchy_levels())
    open(recorder, kind, {.ray_level = finest_level}, progress);
  recorder.stage("rays_hierarchy");
  packets_.record(recorder, gpu::NoPush{}, gpu::ARGS_WALK_BLOCKS);
  walk_.intersect(recorder, kind, progress.opened);
}

void TraverseClasses::trace(Recorder& recorder, const RayList& list, std::uint32_t kind, std::uint32_t) {
  list.bind(recorder);
  recorder.bind(ROLE_RAY_CELLS, ray_cells_);
  sort(recorder, kind);
  recorder.bind(ROLE_CELL_STOPS, cell_stops_);
  recorder.bind(ROLE_CELL_OFFSETS, cell_offsets_);
  recorder.fill(context_.memory.counters, 0, gpu::COUNT_CELLS * 4, 4);
  walk_.trace(
      recorder, gpu::COUNT_RAYS + kind, gpu::BUNDLE, [&](WalkRange rays) { record_walk(recorder, kind, rays); },
      [&](WalkRange rays) { walk_.trace_singly(recorder, kind, rays.first, rays.most); });
}

}  // namespace sheaf
