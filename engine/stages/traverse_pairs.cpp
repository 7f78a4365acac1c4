// SPDX-License-Identifier: MIT
#include "stages/traverse_pairs.hpp"

#include <algorithm>
#include <array>

#include "interface/push/objects.h"
#include "interface/push/trace.h"

namespace sheaf {
namespace {

constexpr std::uint32_t mesh_levels = 3;  // levels below the root on which mesh spheres stand for their triangles
constexpr std::uint32_t least_batch = 4096;
constexpr std::uint32_t most_seeds = 1U << 16U;  // of one upload

std::uint32_t groups(std::uint64_t items) { return static_cast<std::uint32_t>((items + gpu::GROUP - 1) / gpu::GROUP); }

// Level on which parts open into their triangles: 1, nodes of four rays, and one more for each four times as many rays
// to a triangle from 64 on, where nodes of more rays are as small as a part. Measured: rays against parts (level 0)
// take up to three times the tests, a level too high up to half as many again.
std::uint32_t level_of_opening(std::uint32_t rays, std::uint64_t triangles) {
  std::uint32_t level = 1;
  for (std::uint64_t dense = rays / (16 * triangles); dense >= 4; dense /= 4) ++level;
  return level;
}

}  // namespace

TraversePairs::TraversePairs(const TraceContext& c) : context_(c), hierarchy_(c.device), compact_(c.device, "pairs") {
  const std::array constants{SpecConstant{SPEC_TRANSFORM_ON_FETCH, c.plan.transform_on_fetch}};
  spheres_ = Kernel(c.device, "objects_spheres", constants);
  if (c.plan.sorts) sort_ = SortRays(c);
  const std::array counting{SpecConstant{SPEC_COUNTED, c.counted},
                            SpecConstant{SPEC_PIXEL_COUNTED, c.settings.layers.tests}};
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
  if (c.strategy == Strategy::crsh) cut_meshes();
  meshes_.upload(c.device, "meshes");
  parts_.upload(c.device, "parts");
  candidates_ = Buffer(c.device, "pairs", std::uint64_t{capacity_} * 8);
  flags_ = Buffer(c.device, "surviving pairs", std::uint64_t{capacity_} * 4);
  seeds_ = Buffer(c.device, "seeds", std::uint64_t{most_seeds} * sizeof(PairSeed), Buffer::Kind::upload);
  block_sums_ = Buffer(c.device, "block sums", (std::uint64_t{capacity_} / gpu::SCAN_BLOCK + 1) * 4);
  counter_readback_ = Buffer(c.device, "counters", gpu::COUNT_WORDS * 4, Buffer::Kind::readback);
  collected_ = Buffer(c.device, "surviving pairs", std::uint64_t{capacity_} * 8, Buffer::Kind::readback);
}

// A mesh's triangles lie in the order of its hierarchy's leaves, so that runs of them are neighbours.
void TraversePairs::cut_meshes() {
  for (const auto& instance : context_.scene.layout().instances) {
    const auto [first, count] = std::pair{instance.first_triangle, instance.triangle_count};
    meshes_.all.emplace_back(first, count);
    parts_of_mesh_.emplace_back(parts_.all.size(), (count + gpu::PART_TRIANGLES - 1) / gpu::PART_TRIANGLES);
    for (std::uint32_t t = 0; t < count; t += gpu::PART_TRIANGLES)
      parts_.all.emplace_back(first + t, std::min(gpu::PART_TRIANGLES, count - t));
  }
}

void TraversePairs::Runs::upload(const Device& device, const std::string& name) {
  table = Buffer(device, name, all.size() * sizeof(glm::uvec2), Buffer::Kind::upload);
  std::ranges::copy(all, table.view<glm::uvec2>().begin());
  spheres = Buffer(device, name + "' spheres", all.size() * 16);
}

void TraversePairs::record_spheres(Recorder& recorder, const Runs& runs) const {
  recorder.bind(ROLE_SPHERES, runs.spheres);
  recorder.bind(ROLE_RUNS, runs.table);
  const auto count = static_cast<std::uint32_t>(runs.all.size());
  if (count != 0) recorder.dispatch(spheres_, gpu::SpheresPush{count}, groups(count));
}

void TraversePairs::objects_moved(Recorder& recorder, const Motion& motion) {
  if (motion.moved_instances == 0) return;
  recorder.stage("objects");
  recorder.bind(ROLE_SPHERES, triangle_spheres_);
  recorder.bind(ROLE_RUNS, parts_.table);
  recorder.dispatch(spheres_, gpu::SpheresPush{0}, groups(context_.scene.triangles()));
  record_spheres(recorder, meshes_);
  record_spheres(recorder, parts_);
}

std::uint32_t TraversePairs::read_counter(Recorder& recorder, std::uint32_t counter) {
  recorder.copy(context_.memory.counters, counter_readback_, gpu::COUNT_WORDS * 4);
  recorder.submit_and_wait();
  return counter_readback_.view<std::uint32_t>()[counter];
}

void TraversePairs::Seeds::add(std::uint32_t node, std::uint32_t first_object, std::uint32_t objects) {
  all.push_back({node, first_object, static_cast<std::uint32_t>(candidates), 0});
  candidates += objects;
}

// Tests a batch of a step's candidates and compacts the survivors into survivors_[step].
void TraversePairs::test(Recorder& recorder, const Walk& walk, std::size_t step, std::uint32_t candidates,
                         std::uint32_t offset, std::uint32_t seeds) {
  while (survivors_.size() <= step)
    survivors_.emplace_back(context_.device, "surviving pairs", std::uint64_t{capacity_} * 8);
  const auto [level, spheres, opens_parts] = walk.steps[step];
  recorder.stage("traverse");
  recorder.bind(ROLE_PAIRS, candidates_);
  recorder.bind(ROLE_SURVIVORS, flags_);
  recorder.bind(ROLE_SEEDS, seeds_);
  recorder.bind(ROLE_SPHERES, *spheres);
  recorder.bind(ROLE_RUNS, parts_.table);
  if (seeds == 0) recorder.bind(ROLE_PAIRS_NEXT, survivors_[step - 1]);
  const gpu::TraversePairsPush push{
      walk.kind, level, walk.levels[level].first_word, walk.levels[level].nodes, candidates,
      offset,    seeds, opens_parts ? 1U : 0U};
  recorder.dispatch(test_, push, groups(candidates));
  pairs_[level] += candidates;

  recorder.stage("compact");
  recorder.bind(ROLE_PAIRS_NEXT, survivors_[step]);
  recorder.bind(ROLE_BLOCK_SUMS, block_sums_);
  recorder.fill(context_.memory.counters, candidates, gpu::COUNT_PAIRS * 4, 4);
  compact_.record_blocks(recorder, gpu::KindPush{walk.kind}, (candidates + gpu::SCAN_BLOCK - 1) / gpu::SCAN_BLOCK);
  recorder.bind(ROLE_BLOCK_SUMS, context_.memory.block_sums);
}

// What survived a step: opened for the next one, or, after the last, intersected or collected.
void TraversePairs::descend(Recorder& recorder, const Walk& walk, std::size_t step) {
  const std::uint32_t pairs = read_counter(recorder, gpu::COUNT_SURVIVORS);
  if (pairs == 0) return;
  if (step + 1 < walk.steps.size()) {
    walk_parents(recorder, walk, step, pairs);
  } else if (walk.survivors != nullptr) {
    recorder.copy(survivors_[step], collected_, std::uint64_t{pairs} * 8);
    recorder.submit_and_wait();
    const auto found = collected_.view<glm::uvec2>();
    walk.survivors->insert(walk.survivors->end(), found.begin(), found.begin() + pairs);
  } else {
    recorder.stage("intersect");
    recorder.bind(ROLE_PAIRS, survivors_[step]);
    const gpu::IntersectPairsPush push{walk.kind, pairs, 0};
    recorder.dispatch(walk.kind == gpu::KIND_SHADOW ? any_ : nearest_, push, groups(pairs));
  }
}

void TraversePairs::walk_parents(Recorder& recorder, const Walk& walk, std::size_t step, std::uint32_t parents) {
  const std::uint32_t opened = walk.steps[step + 1].opens_parts ? gpu::PART_TRIANGLES : gpu::ARITY;
  const std::uint32_t batch = capacity_ / opened;
  for (std::uint32_t first = 0; first < parents; first += batch) {
    const std::uint32_t count = std::min(batch, parents - first);
    test(recorder, walk, step + 1, count * opened, first, 0);
    descend(recorder, walk, step + 1);
  }
}

void TraversePairs::walk_seeds(Recorder& recorder, const Walk& walk, const Seeds& seeds) {
  for (std::size_t first = 0; first < seeds.all.size(); first += most_seeds) {
    const std::size_t count = std::min<std::size_t>(most_seeds, seeds.all.size() - first);
    const std::uint32_t before = seeds.all[first].before;
    const std::uint64_t end = first + count < seeds.all.size() ? seeds.all[first + count].before : seeds.candidates;
    recorder.submit_and_wait();  // the seeds at work are read by then
    for (std::size_t i = 0; i < count; ++i) {
      seeds_.view<PairSeed>()[i] = seeds.all[first + i];
      seeds_.view<PairSeed>()[i].before -= before;
    }
    for (std::uint64_t at = 0; at < end - before; at += capacity_) {
      const auto batch = static_cast<std::uint32_t>(std::min<std::uint64_t>(capacity_, end - before - at));
      test(recorder, walk, 0, batch, static_cast<std::uint32_t>(at), static_cast<std::uint32_t>(count));
      descend(recorder, walk, 0);
    }
  }
}

// Steps of the nodes from one level down to another against objects of a kind.
void TraversePairs::Walk::step_down(std::uint32_t from, std::uint32_t to, const Buffer& spheres) {
  for (std::uint32_t level = from + 1; level-- > to;) steps.push_back({level, &spheres});
}

TraversePairs::Seeds TraversePairs::begin_at_triangles(Walk& walk) const {
  walk.step_down(walk.top(), 0, triangle_spheres_);
  Seeds seeds;
  seeds.add(0, 0, static_cast<std::uint32_t>(context_.scene.triangles()));
  return seeds;
}

// C's coarse phase: nodes against the meshes' spheres, a few levels down. What survives opens into the meshes' parts;
// these, near the rays, into triangles.
TraversePairs::Seeds TraversePairs::begin_at_meshes(Recorder& recorder, Walk& walk, std::uint32_t rays) {
  const std::uint32_t coarse = walk.top() > mesh_levels ? walk.top() - mesh_levels : 0;
  const std::uint32_t opening = std::min(level_of_opening(rays, context_.scene.triangles()), coarse);
  std::vector<glm::uvec2> survivors;
  Walk meshes{walk.kind, walk.levels, {}, &survivors};
  meshes.step_down(walk.top(), coarse, meshes_.spheres);
  Seeds root, seeds;
  root.add(0, 0, static_cast<std::uint32_t>(meshes_.all.size()));
  walk_seeds(recorder, meshes, root);
  for (const auto& pair : survivors) seeds.add(pair.x, parts_of_mesh_[pair.y].x, parts_of_mesh_[pair.y].y);

  walk.step_down(coarse, opening, parts_.spheres);
  walk.steps.push_back({opening, &triangle_spheres_, true});
  if (opening > 0) walk.step_down(opening - 1, 0, triangle_spheres_);
  return seeds;
}

void TraversePairs::reset_hits(Recorder& recorder, std::uint32_t kind) {
  const gpu::IntersectPairsPush push{kind, 0, 1};
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
  walk_seeds(recorder, walk,
             context_.strategy == Strategy::crsh ? begin_at_meshes(recorder, walk, rays) : begin_at_triangles(walk));
}

}  // namespace sheaf
