// SPDX-License-Identifier: MIT
// The hierarchy over rays (R 4.3): every ray of every node lies in the node's sphere and cone, in double precision, no
// tolerance.
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "device_fixture.hpp"
#include "interface/push/trace.h"
#include "stages/rays_hierarchy.hpp"
#include "stages/tracer.hpp"

namespace sheaf::test {
namespace {

using Rays = std::vector<TestRay>;
constexpr std::uint32_t kind = gpu::KIND_REFLECTION;
constexpr float half_pi = 1.57079632679F;

struct Node {  // as the kernels write it
  glm::vec3 centre;
  float radius;
  glm::vec3 axis;
  float angle, tmax;
};
static_assert(sizeof(Node) == gpu::RAY_NODE_WORDS * 4);

struct Batch {
  std::string name;
  std::function<TestRay(Dice&, std::uint32_t)> ray;
};

glm::vec3 unit_float(const glm::dvec3& v) { return {glm::normalize(v)}; }

/// A direction at `angle` from `axis`.
glm::dvec3 turned(Dice& dice, const glm::dvec3& axis, double angle) {
  const glm::dvec3 u = square_to(axis), v = glm::cross(axis, u);
  const double turn = dice.range(0, 6.283185307179586);
  return axis * std::cos(angle) + (u * std::cos(turn) + v * std::sin(turn)) * std::sin(angle);
}

TestRay ray_of(const glm::dvec3& origin, const glm::dvec3& direction, double tmax = 1e30) {
  TestRay ray;
  ray.origin = glm::vec3(origin);
  ray.direction = unit_float(direction);
  ray.tmax = static_cast<float>(tmax);
  return ray;
}

std::vector<Batch> batches() {
  const glm::dvec3 axis = glm::normalize(glm::dvec3(0.3, -0.5, 0.8));
  std::vector<Batch> all{
      {"random", [](Dice& d, auto) { return ray_of(d.cube(), d.direction(), d.magnitude(1e-3, 1e3)); }},
      {"one point",
       [](Dice& d, auto) {
         return ray_of({3, 4, 5}, d.direction());
       }},
      {"parallel", [=](Dice& d, auto) { return ray_of(d.cube(), axis); }},
      {"all equal",
       [=](Dice&, auto) {
         return ray_of({1, 2, 3}, axis);
       }},
      {"antiparallel", [=](Dice& d, auto i) { return ray_of(d.cube(), i % 2 == 0 ? axis : -axis); }},
      {"nearly antiparallel",
       [=](Dice& d, auto i) {
         return ray_of(d.cube(), turned(d, i % 2 == 0 ? axis : -axis, d.magnitude(1e-8, 1e-3)));
       }},
      {"six axes",
       [](Dice& d, auto i) {
         glm::dvec3 v(0);
         v[static_cast<int>(i % 3)] = i % 6 < 3 ? 1 : -1;
         return ray_of(d.cube(), v);
       }},
      {"far from the origin",
       [](Dice& d, auto) { return ray_of(glm::dvec3(1e7, -1e7, 1e7) + d.cube() * 5.0, d.direction()); }},
      {"far and parallel", [=](Dice& d, auto) { return ray_of(glm::dvec3(-1e7, 0, 1e7) + d.cube(), axis); }},
      {"tiny", [](Dice& d, auto) { return ray_of(d.cube() * 1e-7, d.direction()); }},
      {"tiny differences",
       [=](Dice& d, auto) { return ray_of(glm::dvec3(1e-7) + d.cube() * 1e-12, turned(d, axis, 1e-7)); }},
      {"huge", [](Dice& d, auto) { return ray_of(d.cube() * 1e7, d.direction(), 1e9); }},
      {"one ulp apart",
       [=](Dice&, auto i) {
         TestRay ray = ray_of({1e7, 1, 1e-7}, axis);
         if (i % 2 == 1)
           ray.origin = {std::nextafter(1e7F, 1e9F), std::nextafter(1.0F, 0.0F), std::nextafter(1e-7F, 1.0F)};
         if (i % 2 == 1) ray.direction.x = std::nextafter(ray.direction.x, 2.0F);
         return ray;
       }},
      {"all sizes", [](Dice& d, auto) {
         return ray_of(d.direction() * d.magnitude(1e-6, 1e6), d.direction(), d.magnitude(1e-6, 1e6));
       }}};
  for (const double spread : {1e-7, 1e-5, 1e-3, 0.03, 0.3, 1.0, 1.5, 1.6})
    all.push_back({"cone of " + std::to_string(spread), [=](Dice& d, auto) {
                     return ray_of(d.cube() * spread, turned(d, axis, spread * std::sqrt(d.unit())));
                   }});
  // Opening steadily: whatever an approximate atan or asin errs by, somewhere the sweep meets its worst.
  all.push_back({"opening", [=](Dice& d, auto i) {
                   return ray_of(d.cube() * 1e-3, turned(d, axis, 1e-6 * std::pow(1.5e6, (i / 64) % 997 / 997.0)));
                 }});
  return all;
}

struct Excess {  // by how much rays leave their node, at worst
  double radius = 0, angle = 0;
  std::size_t violations = 0;
};

void add_ray(Excess& excess, const Node& node, const TestRay& ray) {
  const double distance = glm::length(glm::dvec3(ray.origin) - glm::dvec3(node.centre));
  const glm::dvec3 axis(node.axis), direction(ray.direction);
  const double angle = std::atan2(glm::length(glm::cross(axis, direction)), glm::dot(axis, direction));
  const bool has_cone = node.angle < half_pi;  // past it: every direction
  const bool outside = !(distance <= node.radius) || (has_cone && !(angle <= node.angle)) || !(ray.tmax <= node.tmax);
  excess.violations += outside ? 1 : 0;
  excess.radius = std::max(excess.radius, distance - node.radius);
  if (has_cone) excess.angle = std::max(excess.angle, angle - node.angle);
}

/// The rays in a list whose order is not that of the slots.
class ListOnDevice {
 public:
  explicit ListOnDevice(const Rays& rays) : recorder_(device()) {
    const auto count = static_cast<std::uint32_t>(rays.size());
    gpu::Frame frame{};
    frame.capacity = count + 1;
    Rays reversed(rays.rbegin(), rays.rend());
    std::vector<std::uint32_t> order(count), counters(gpu::COUNT_WORDS);
    for (std::uint32_t i = 0; i < count; ++i) order[i] = count - 1 - i;
    counters[gpu::COUNT_RAYS + kind] = count;
    nodes_ = buffer_of(std::vector<std::uint32_t>(gpu::NODE_WORDS));
    frame.nodes_at = nodes_.address_words();
    frame_ = buffer_of(std::vector{frame});
    rays_ = buffer_of(pack_rays(reversed, frame.capacity));
    order_ = buffer_of(order);
    counters_ = buffer_of(counters);
    recorder_.bind(ROLE_FRAME, frame_);
    recorder_.bind_list(LIST_RAYS, rays_);
    recorder_.bind_list(LIST_ORDER, order_);
    recorder_.bind(ROLE_COUNTERS, counters_);
  }
  Recorder& recorder() { return recorder_; }

 private:
  Buffer nodes_, frame_, rays_, order_, counters_;
  Recorder recorder_;
};

std::vector<Node> as_nodes(const std::vector<float>& words) {
  std::vector<Node> nodes(words.size() / gpu::RAY_NODE_WORDS);
  if (!nodes.empty()) std::memcpy(nodes.data(), words.data(), nodes.size() * sizeof(Node));
  return nodes;
}

std::vector<std::uint32_t> ray_counts() {
  return {1, 2, 3, 4, 5, 7, 8, 9, 15, 16, 17, 63, 64, 65, 255, 256, 257, 1023, 1024, 1025, 4096, 4097, 20001, 65537};
}

Rays make_rays(const Batch& batch, std::uint32_t count) {
  Dice dice(count);
  Rays rays;
  for (std::uint32_t i = 0; i < count; ++i) rays.push_back(batch.ray(dice, i));
  return rays;
}

TEST(DeviceRaysHierarchy, LevelsShrinkByFourDownToOne) {
  for (const std::uint32_t n : {0U, 1U, 4U, 5U, 64U, 65U, 1U << 24U}) {
    const auto levels = hierarchy_levels(n);
    EXPECT_EQ(levels.front().nodes, n);
    EXPECT_LE(levels.back().nodes, 1U);
    for (std::size_t l = 1; l < levels.size(); ++l) EXPECT_EQ(levels[l].nodes, (levels[l - 1].nodes + 3) / 4);
    EXPECT_LE(levels.size(), gpu::MAX_LEVELS);
  }
}

TEST(DeviceRaysHierarchy, NodesOfEveryLevelHoldTheirRays) {
  const RaysHierarchy stage(device());
  for (const auto& batch : batches())
    for (const auto count : ray_counts()) {
      const Rays rays = make_rays(batch, count);
      ListOnDevice on_device(rays);
      const auto levels = hierarchy_levels(count);
      const std::size_t words = levels.back().first_word + (levels.size() > 1 ? gpu::RAY_NODE_WORDS : 0);
      RayMemory memory;
      memory.ray_nodes = Buffer(device(), "nodes", words * 4 + 64, Buffer::Kind::upload);
      stage.record(on_device.recorder(), memory, kind, levels);
      const auto all = as_nodes(read<float>(on_device.recorder(), memory.ray_nodes, words));
      Excess excess;
      std::uint64_t span = 1;
      for (std::size_t l = 1; l < levels.size(); ++l) {
        span *= gpu::ARITY;
        for (std::size_t i = 0; i < rays.size(); ++i)
          add_ray(excess, all[levels[l].first_word / gpu::RAY_NODE_WORDS + i / span], rays[i]);
      }
      ASSERT_EQ(excess.violations, 0U) << batch.name << ", " << count << " rays: outside by " << excess.radius << " m, "
                                       << excess.angle << " rad";
    }
}

// Among no objects at all: only what is too wide, or too few, is left to others.
TEST(DeviceRaysHierarchy, BundlesThatAreWideGoAlone) {
  const std::uint32_t bundle = device().limits().bundle;
  auto constants = lane_constants(device(), bundle);
  for (const std::uint32_t off : {SPEC_MASKED, SPEC_TRANSLUCENT, SPEC_TEXTURED}) constants.push_back({off, 0});
  const Kernel kernel(device(), "traverse_bundles", constants);
  const std::map<std::string, bool> loose{{"random", true},    {"antiparallel", true},      {"six axes", true},
                                          {"parallel", false}, {"cone of 0.001000", false}, {"cone of 1.000000", true}};
  for (const auto& batch : batches())
    for (const auto count : ray_counts()) {
      const auto is_incoherent = loose.find(batch.name);
      if (is_incoherent == loose.end()) continue;
      ListOnDevice on_device(make_rays(batch, count));
      const Output<std::uint32_t> work(blocks_of(count, bundle));
      Buffer args = buffer_of(std::vector<std::uint32_t>(std::size_t{gpu::ARGS_COUNT} * 3));
      const Output<std::uint64_t> hits(count);
      on_device.recorder().bind(ROLE_INCOHERENT_BUNDLES, work.buffer());
      on_device.recorder().bind(ROLE_ARGS, args);
      on_device.recorder().bind_list(LIST_HITS, hits.buffer());
      const gpu::TraverseBundlesPush push{kind, 250, 0.1F};
      on_device.recorder().dispatch(kernel, push, blocks_of(count, bundle) + 1ULL);
      on_device.recorder().submit_and_wait();
      std::vector<std::uint32_t> expected;
      for (std::uint32_t b = 0; b < blocks_of(count, bundle); ++b)
        if (is_incoherent->second || count - b * bundle < 8) expected.push_back(b);
      auto alone = work.values();
      alone.resize(args.view<std::uint32_t>()[gpu::ARGS_INCOHERENT * 3]);
      std::sort(alone.begin(), alone.end());
      ASSERT_EQ(alone, expected) << batch.name << ", " << count << " rays";
    }
}

// Bounds that hold everything would pass the above: they must also be worth having.
TEST(DeviceRaysHierarchy, BoundsAreTight) {
  const RaysHierarchy stage(device());
  for (const double spread : {1e-4, 1e-2, 0.1}) {
    Dice dice(3);
    const glm::dvec3 axis = dice.direction();
    Rays rays;
    for (int i = 0; i < 64; ++i) rays.push_back(ray_of(dice.cube() * spread, turned(dice, axis, spread)));
    ListOnDevice on_device(rays);
    const auto levels = hierarchy_levels(64);
    RayMemory memory;
    memory.ray_nodes = Buffer(device(), "nodes", 21 * sizeof(Node), Buffer::Kind::upload);
    stage.record(on_device.recorder(), memory, kind, levels);
    const auto nodes = as_nodes(read<float>(on_device.recorder(), memory.ray_nodes, 21 * gpu::RAY_NODE_WORDS));
    EXPECT_LT(nodes[20].angle, 2.5 * spread);  // three levels, each of which may lean to one side
    EXPECT_LT(nodes[20].radius, 2.5 * std::sqrt(3.0) * spread);
  }
}

}  // namespace
}  // namespace sheaf::test
