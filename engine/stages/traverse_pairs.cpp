// SPDX-License-Identifier: MIT
#include "stages/traverse_pairs.hpp"

#include <algorithm>
#include <array>

namespace sheaf {
namespace {

constexpr std::uint32_t mesh_levels = 3;  // levels below the root on which mesh spheres stand for their triangles
constexpr std::uint32_t least_batch = 4096;
constexpr std::uint32_t most_seeds = 1U << 16U;  // of one upload

std::uint32_t groups(std::uint64_t items) { return static_cast<std::uint32_t>((items + gpu::GROUP - 1) / gpu::GROUP); }

}  // namespace

TraversePairs::TraversePairs(const TraceContext& c) : context_(c), hierarchy_(c.device), compact_(c.device, "pairs") {
  const std::array posed{SpecConstant{12, c.plan.posed}};
  spheres_ = Kernel(c.device, "objects_spheres", posed);
  if (c.plan.sorts) sort_ = SortRays(c);
  const std::array counting{SpecConstant{6, c.counted}, SpecConstant{7, c.settings.layers.tests}};
  test_ = Kernel(c.device, "traverse_pairs", counting);
  auto make = [&](bool any_hit) { return Kernel(c.device, "intersect_pairs", candidate_constants(c, any_hit)); };
  nearest_ = make(false);
  if (c.plan.shadows) any_ = make(true);

  // A quarter of the budget: candidates and flags once, survivors once a level.
  const std::uint64_t budget = (c.settings.memory_mib << 20U) / 4;
  capacity_ = static_cast<std::uint32_t>(
      std::clamp<std::uint64_t>(budget / (8 + 4 + 8 * gpu::MAX_LEVELS), least_batch, std::uint64_t{1} << 22U));
  capacity_ = capacity_ / gpu::SCAN_BLOCK * gpu::SCAN_BLOCK;
  triangle_spheres_ = Buffer(c.device, "triangle spheres", std::uint64_t{c.scene.triangles()} * 16);
  mesh_spheres_ = Buffer(c.device, "mesh spheres", c.scene.layout().instances.size() * 16);
  candidates_ = Buffer(c.device, "pairs", std::uint64_t{capacity_} * 8);
  flags_ = Buffer(c.device, "surviving pairs", std::uint64_t{capacity_} * 4);
  seeds_ = Buffer(c.device, "seeds", std::uint64_t{most_seeds} * sizeof(PairSeed), Buffer::Kind::upload);
  block_sums_ = Buffer(c.device, "block sums", (std::uint64_t{capacity_} / gpu::SCAN_BLOCK + 1) * 4);
  counter_readback_ = Buffer(c.device, "counters", gpu::COUNT_WORDS * 4, Buffer::Kind::readback);
  collected_ = Buffer(c.device, "surviving pairs", std::uint64_t{capacity_} * 8, Buffer::Kind::readback);
}

void TraversePairs::objects_moved(Recorder& recorder, const Motion& motion) {
  if (motion.moved_instances == 0) return;
  recorder.stage("objects");
  recorder.bind(ROLE_SPHERES, triangle_spheres_);
  recorder.bind(ROLE_MESH_SPHERES, mesh_spheres_);
  recorder.dispatch(spheres_, 0U, groups(context_.scene.triangles()));
  if (context_.strategy == Strategy::crsh)
    recorder.dispatch(spheres_, 1U, groups(context_.scene.layout().instances.size()));
}

std::uint32_t TraversePairs::read_counter(Recorder& recorder, std::uint32_t counter) {
  recorder.copy(context_.memory.counters, counter_readback_, gpu::COUNT_WORDS * 4);
  recorder.submit_and_wait();
  return counter_readback_.view<std::uint32_t>()[counter];
}

// Tests a batch of candidates on a level and compacts the survivors into survivors_[level].
void TraversePairs::test(Recorder& recorder, const Walk& walk, std::uint32_t level, std::uint32_t candidates,
                         std::uint32_t offset, std::uint32_t seeds) {
  while (survivors_.size() <= level)
    survivors_.emplace_back(context_.device, "surviving pairs", std::uint64_t{capacity_} * 8);
  recorder.stage("traverse");
  recorder.bind(ROLE_PAIRS, candidates_);
  recorder.bind(ROLE_SURVIVORS, flags_);
  recorder.bind(ROLE_SKELETON, seeds_);
  if (seeds == 0) recorder.bind(ROLE_PAIRS_NEXT, survivors_[level + 1]);
  const struct {
    std::uint32_t kind, level, first_word, nodes, candidates, offset, seeds;
  } push{walk.kind, level, walk.levels[level].first_word, walk.levels[level].nodes, candidates, offset, seeds};
  recorder.dispatch(test_, push, groups(candidates));
  pairs_[level] += candidates;

  recorder.stage("compact");
  recorder.bind(ROLE_PAIRS_NEXT, survivors_[level]);
  recorder.bind(ROLE_BLOCK_SUMS, block_sums_);
  recorder.fill(context_.memory.counters, candidates, gpu::COUNT_PAIRS * 4, 4);
  compact_.record_blocks(recorder, {walk.kind}, (candidates + gpu::SCAN_BLOCK - 1) / gpu::SCAN_BLOCK);
  recorder.bind(ROLE_BLOCK_SUMS, context_.memory.block_sums);
}

// What survived a level: opened on the next one, or, at the bottom, intersected or collected.
void TraversePairs::descend(Recorder& recorder, const Walk& walk, std::uint32_t level) {
  const std::uint32_t pairs = read_counter(recorder, gpu::COUNT_SURVIVORS);
  if (pairs == 0) return;
  if (level > walk.bottom) {
    walk_parents(recorder, walk, level, pairs);
  } else if (walk.survivors != nullptr) {
    recorder.copy(survivors_[level], collected_, std::uint64_t{pairs} * 8);
    recorder.submit_and_wait();
    const auto found = collected_.view<glm::uvec2>();
    walk.survivors->insert(walk.survivors->end(), found.begin(), found.begin() + pairs);
  } else {
    recorder.stage("intersect");
    recorder.bind(ROLE_PAIRS, survivors_[level]);
    const struct { std::uint32_t kind, pairs, reset; } push{walk.kind, pairs, 0};
    recorder.dispatch(walk.kind == gpu::KIND_SHADOW ? any_ : nearest_, push, groups(pairs));
  }
}

void TraversePairs::walk_parents(Recorder& recorder, const Walk& walk, std::uint32_t level, std::uint32_t parents) {
  const std::uint32_t batch = capacity_ / gpu::ARITY;
  for (std::uint32_t first = 0; first < parents; first += batch) {
    const std::uint32_t count = std::min(batch, parents - first);
    test(recorder, walk, level - 1, count * gpu::ARITY, first, 0);
    descend(recorder, walk, level - 1);
  }
}

void TraversePairs::walk_seeds(Recorder& recorder, const Walk& walk, std::uint32_t level, std::vector<PairSeed> seeds,
                               std::uint64_t candidates) {
  for (std::size_t first = 0; first < seeds.size(); first += most_seeds) {
    const std::size_t count = std::min<std::size_t>(most_seeds, seeds.size() - first);
    const std::uint32_t before = seeds[first].before;
    const std::uint64_t end = first + count < seeds.size() ? seeds[first + count].before : candidates;
    recorder.submit_and_wait();  // the seeds at work are read by then
    for (std::size_t i = 0; i < count; ++i) {
      seeds_.view<PairSeed>()[i] = seeds[first + i];
      seeds_.view<PairSeed>()[i].before -= before;
    }
    for (std::uint64_t at = 0; at < end - before; at += capacity_) {
      const auto batch = static_cast<std::uint32_t>(std::min<std::uint64_t>(capacity_, end - before - at));
      test(recorder, walk, level, batch, static_cast<std::uint32_t>(at), static_cast<std::uint32_t>(count));
      descend(recorder, walk, level);
    }
  }
}

// C's coarse phase: nodes against the meshes' spheres, a few levels down; the survivors open into the meshes'
// triangles.
std::vector<PairSeed> TraversePairs::mesh_seeds(Recorder& recorder, Walk walk, std::uint32_t top, std::uint32_t& level,
                                                std::uint64_t& candidates) {
  std::vector<glm::uvec2> pairs;
  level = top > mesh_levels ? top - mesh_levels : 0;
  walk.bottom = level;
  walk.survivors = &pairs;
  recorder.bind(ROLE_SPHERES, mesh_spheres_);
  const auto& instances = context_.scene.layout().instances;
  if (!instances.empty()) walk_seeds(recorder, walk, top, {PairSeed{0, 0, 0, 0}}, instances.size());
  std::vector<PairSeed> seeds;
  candidates = 0;
  for (const auto& pair : pairs) {
    const auto& instance = instances[pair.y];
    seeds.push_back({pair.x, instance.first_triangle, static_cast<std::uint32_t>(candidates), 0});
    candidates += instance.triangle_count;
  }
  return seeds;
}

void TraversePairs::reset_hits(Recorder& recorder, std::uint32_t kind) {
  const struct { std::uint32_t kind, pairs, reset; } push{kind, 0, 1};
  recorder.dispatch_indirect(kind == gpu::KIND_SHADOW ? any_ : nearest_, push, gpu::ARGS_RAYS);
}

void TraversePairs::trace(Recorder& recorder, const RayList& list, std::uint32_t kind, std::uint32_t) {
  pairs_.clear();
  list.bind(recorder);
  if (context_.plan.sorts && kind != gpu::KIND_PRIMARY) sort_.record(recorder, context_, kind);
  recorder.stage("intersect");
  reset_hits(recorder, kind);
  const std::uint32_t rays = read_counter(recorder, gpu::COUNT_RAYS + kind);
  if (rays == 0 || context_.scene.triangles() == 0) return;
  Walk walk;
  walk.kind = kind;
  walk.levels = hierarchy_levels(rays);
  pairs_.assign(walk.levels.size(), 0);
  hierarchy_.record(recorder, context_.memory, kind, walk.levels);
  const auto top = static_cast<std::uint32_t>(walk.levels.size() - 1);
  std::uint32_t level = top;
  std::uint64_t candidates = context_.scene.triangles();
  std::vector<PairSeed> seeds{{0, 0, 0, 0}};
  if (context_.strategy == Strategy::crsh) seeds = mesh_seeds(recorder, walk, top, level, candidates);
  recorder.bind(ROLE_SPHERES, triangle_spheres_);
  walk_seeds(recorder, walk, level, std::move(seeds), candidates);
}

}  // namespace sheaf
