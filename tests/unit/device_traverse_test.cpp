// SPDX-License-Identifier: MIT
// A node of the ray hierarchy against a bounding sphere (traverse_pairs): no culled pair holds a ray that meets the
// sphere, in double precision, and what is clearly apart is culled. Sizes and distances from 1e-6 to 1e6.
#include <algorithm>
#include <cmath>

#include "device_fixture.hpp"
#include "interface/push/trace.h"

namespace sheaf::test {
namespace {

constexpr std::uint32_t kind = gpu::KIND_REFLECTION;
constexpr double right_angle = 1.5707963267948966;

struct Node {  // as the kernels read it
  glm::vec3 centre;
  float radius;
  glm::vec3 axis;
  float angle, tmax;
};
static_assert(sizeof(Node) == gpu::RAY_NODE_WORDS * 4);

struct Seed {
  std::uint32_t node, first_object, before, unused;
};

struct Ray {
  glm::dvec3 origin, direction;
};

bool meets(const Ray& ray, double tmax, const glm::vec4& sphere) {
  const glm::dvec3 to_centre = glm::dvec3(sphere) - ray.origin;
  const double nearest = std::clamp(glm::dot(to_centre, ray.direction), 0.0, tmax);
  const glm::dvec3 apart = to_centre - ray.direction * nearest;
  return glm::dot(apart, apart) <= double{sphere.w} * sphere.w;
}

/// Some ray of the node, as often as not one on its very edge.
Ray ray_within(Dice& dice, const Node& node) {
  const glm::dvec3 axis = glm::normalize(glm::dvec3(node.axis)), u = square_to(axis), v = glm::cross(axis, u);
  const double turn = dice.range(0, 4 * right_angle), edge = 1 - 1e-9;
  const double angle = std::min<double>(node.angle, 2 * right_angle) * (dice.below(2) != 0 ? edge : dice.unit() * edge);
  const double radius = node.radius * (dice.below(2) != 0 ? edge : dice.unit() * edge);
  return {glm::dvec3(node.centre) + dice.direction() * radius,
          axis * std::cos(angle) + (u * std::cos(turn) + v * std::sin(turn)) * std::sin(angle)};
}

/// A sphere that the ray grazes, pierces, or touches with its very beginning or end; and how far the ray goes.
glm::vec4 sphere_on(Dice& dice, const Ray& ray, float& tmax) {
  const auto radius = static_cast<float>(dice.magnitude(1e-6, 1e6));
  const double t = dice.below(4) == 0 ? 0 : dice.magnitude(1e-6, 1e6);
  const double aside = radius * (dice.below(2) != 0 ? 1 - 1e-7 : dice.unit());
  const glm::dvec3 u = square_to(ray.direction), v = glm::cross(ray.direction, u);
  const double turn = dice.range(0, 4 * right_angle), back = std::sqrt(double{radius} * radius - aside * aside);
  glm::dvec3 centre = ray.origin + ray.direction * t + (u * std::cos(turn) + v * std::sin(turn)) * aside;
  if (t == 0) centre -= ray.direction * (back * (1 - 1e-6));  // behind, and reaching the origin
  tmax = std::numeric_limits<float>::infinity();
  if (dice.below(2) != 0) tmax = static_cast<float>(std::max(t - back, 0.0) * (1 + 1e-6));
  return {glm::vec3(centre), radius};
}

Node some_node(Dice& dice) {
  Node node{};
  if (dice.below(8) != 0) node.centre = glm::vec3(dice.direction() * dice.magnitude(1e-6, 1e6));
  if (dice.below(4) != 0) node.radius = static_cast<float>(dice.magnitude(1e-6, 1e6));
  node.axis = dice.below(8) == 0 ? glm::vec3(0, 0, 1) : glm::vec3(dice.direction());
  switch (dice.below(5)) {
    case 0:
      node.angle = 0;
      break;
    case 1:
      node.angle = static_cast<float>(dice.magnitude(1e-7, 1));
      break;
    case 2:
      node.angle = static_cast<float>(dice.range(0, right_angle));
      break;
    case 3:
      node.angle = static_cast<float>(right_angle - dice.magnitude(1e-7, 0.1));
      break;
    default:
      node.angle = static_cast<float>(dice.range(right_angle, 4));
      break;
  }
  return node;
}

/// Whether sphere and node are so far apart that no rounding explains keeping the pair.
bool clearly_apart(const Node& node, const glm::vec4& sphere) {
  const glm::dvec3 v = glm::dvec3(sphere) - glm::dvec3(node.centre);
  const double distance = glm::length(v), reach = double{sphere.w} + node.radius, margin = 1e-4 * (distance + reach);
  if (distance - reach - margin > node.tmax) return true;
  if (node.angle > right_angle * 0.999) return false;
  const double z = glm::dot(v, glm::dvec3(node.axis)), w = glm::length(glm::cross(v, glm::dvec3(node.axis)));
  const double c = std::cos(node.angle), s = std::sin(node.angle);
  if (z * c + w * s < -margin) return distance > reach + margin;
  return w * c - z * s > reach + margin;
}

struct Bindings {
  Buffer ray_nodes, rays, order, frame, seeds, parents, spheres;
};

struct Tested {
  std::vector<glm::uvec2> pairs;
  std::vector<std::uint32_t> survives;
};

Tested test_pairs(const Kernel& kernel, const Bindings& b, const gpu::TraversePairsPush& push) {
  const Output<glm::uvec2> pairs(push.candidates);
  const Output<std::uint32_t> survivors(push.candidates);
  const Buffer counters = buffer_of(std::vector<std::uint32_t>(gpu::COUNT_WORDS));
  Recorder recorder(device());
  auto bind = [&](std::uint32_t role, const Buffer& buffer) {
    if (buffer) recorder.bind(role, buffer);
  };
  bind(ROLE_RAY_NODES, b.ray_nodes);
  if (b.rays) recorder.bind_list(LIST_RAYS, b.rays);
  if (b.order) recorder.bind_list(LIST_ORDER, b.order);
  bind(ROLE_FRAME, b.frame);
  bind(ROLE_SEEDS, b.seeds);
  bind(ROLE_PAIRS_NEXT, b.parents);
  bind(ROLE_SPHERES, b.spheres);
  bind(ROLE_PAIRS, pairs.buffer());
  bind(ROLE_SURVIVORS, survivors.buffer());
  bind(ROLE_COUNTERS, counters);
  recorder.dispatch(kernel, push, blocks_of(push.candidates, gpu::GROUP));
  recorder.submit_and_wait();
  return {pairs.values(), survivors.values()};
}

TEST(DeviceNodeTest, NoNodeIsCulledThatHoldsARayWhichMeetsTheSphere) {
  const Kernel kernel(device(), "traverse_pairs");
  constexpr std::uint32_t count = 1U << 18U, rounds = 8;  // 2 million pairs
  std::size_t hits = 0, apart = 0, missed = 0, kept = 0;
  for (std::uint32_t round = 0; round < rounds; ++round) {
    Dice dice(round);
    std::vector<Node> nodes(count);
    std::vector<glm::vec4> spheres(count);
    std::vector<Seed> seeds(count);
    std::vector<bool> must_survive(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      nodes[i] = some_node(dice);
      const Ray ray = ray_within(dice, nodes[i]);
      spheres[i] = sphere_on(dice, ray, nodes[i].tmax);
      if (dice.below(4) == 0) spheres[i] = {glm::vec3(dice.direction() * dice.magnitude(1e-6, 1e6)), spheres[i].w};
      must_survive[i] = meets(ray, nodes[i].tmax, spheres[i]);
      seeds[i] = {i, i, i, 0};
    }
    Bindings b;
    b.ray_nodes = buffer_of(nodes);
    b.spheres = buffer_of(spheres);
    b.seeds = buffer_of(seeds);
    const Tested got = test_pairs(kernel, b, {kind, 1, 0, count, count, 0, count, 0});
    for (std::uint32_t i = 0; i < count; ++i) {
      const bool far_apart = clearly_apart(nodes[i], spheres[i]);
      ASSERT_FALSE(far_apart && must_survive[i]) << "the test contradicts itself";
      hits += must_survive[i] ? 1 : 0;
      apart += far_apart ? 1 : 0;
      missed += must_survive[i] && got.survives[i] == 0 ? 1 : 0;
      kept += far_apart && got.survives[i] != 0 ? 1 : 0;
      ASSERT_EQ(got.pairs[i], glm::uvec2(i, i));
    }
  }
  EXPECT_EQ(missed, 0U) << "pairs with a hit were culled, of " << hits;
  EXPECT_EQ(kept, 0U) << "pairs clearly apart were kept, of " << apart;
  EXPECT_GT(hits, std::size_t{count} * rounds / 3);
  EXPECT_GT(apart, std::size_t{count} * rounds / 20);
}

// Level 0: the rays themselves, found through the list's order; each parent opens into four of them against one sphere.
TEST(DeviceNodeTest, NoRayIsCulledThatMeetsTheSphere) {
  const Kernel kernel(device(), "traverse_pairs");
  constexpr std::uint32_t parents = 1U << 16U, rays = parents * gpu::ARITY - 2, rounds = 8;  // 2 million pairs
  std::size_t hits = 0, missed = 0, kept = 0, apart = 0;
  for (std::uint32_t round = 0; round < rounds; ++round) {
    Dice dice(100 + round);
    std::vector<TestRay> list(rays);
    std::vector<glm::vec4> spheres(parents);
    std::vector<glm::uvec2> opened(parents);
    std::vector<std::uint32_t> order(rays);
    for (std::uint32_t i = 0; i < rays; ++i) {
      list[i].origin = glm::vec3(dice.direction() * dice.magnitude(1e-6, 1e6));
      list[i].direction = glm::vec3(dice.direction());
      order[i] = rays - 1 - i;
    }
    for (std::uint32_t p = 0; p < parents; ++p) {
      TestRay& ray = list[std::min(p * gpu::ARITY + dice.below(gpu::ARITY), rays - 1)];
      spheres[p] = sphere_on(dice, {ray.origin, glm::normalize(glm::dvec3(ray.direction))}, ray.tmax);
      opened[p] = {p, p};
    }
    const std::vector<TestRay> slots(list.rbegin(), list.rend());
    gpu::Frame frame{};
    frame.capacity = rays;
    Bindings b;
    b.rays = buffer_of(pack_rays(slots, rays));
    b.order = buffer_of(order);
    b.frame = buffer_of(std::vector{frame});
    b.parents = buffer_of(opened);
    b.spheres = buffer_of(spheres);
    const Tested got = test_pairs(kernel, b, {kind, 0, 0, rays, parents * gpu::ARITY, 0, 0, 0});
    for (std::uint32_t i = 0; i < parents * gpu::ARITY; ++i) {
      ASSERT_EQ(got.pairs[i], glm::uvec2(i, i / gpu::ARITY));
      if (i >= rays) {
        ASSERT_EQ(got.survives[i], 0U) << "a ray that does not exist";
        continue;
      }
      const auto& ray = list[i];
      const auto& sphere = spheres[i / gpu::ARITY];
      const bool hit = meets({ray.origin, glm::normalize(glm::dvec3(ray.direction))}, ray.tmax, sphere);
      const bool far_apart = clearly_apart({ray.origin, 0, ray.direction, 0, ray.tmax}, sphere);
      hits += hit ? 1 : 0;
      apart += far_apart ? 1 : 0;
      missed += hit && got.survives[i] == 0 ? 1 : 0;
      kept += far_apart && got.survives[i] != 0 ? 1 : 0;
    }
  }
  EXPECT_EQ(missed, 0U) << "pairs with a hit were culled, of " << hits;
  EXPECT_EQ(kept, 0U) << "pairs clearly apart were kept, of " << apart;
  EXPECT_GT(hits, std::size_t{parents} * rounds / 2);
  EXPECT_GT(apart, std::size_t{parents} * rounds / 2);
}

// A batch of candidates from the middle of the seeds' runs, more than one row of workgroups long.
TEST(DeviceNodeTest, SeedsOpenIntoTheirRunsOfObjects) {
  const Kernel kernel(device(), "traverse_pairs");
  Dice dice(1);
  constexpr std::uint32_t candidates = 32768 * gpu::GROUP + 1000, offset = 777, objects = 5000, nodes = 300;
  std::vector<Seed> seeds;
  std::vector<glm::uvec2> expected;
  while (expected.size() < candidates + offset) {
    const std::uint32_t run = dice.below(4) == 0 ? 1 : 1 + dice.below(2000), first = dice.below(objects - run);
    seeds.push_back({dice.below(nodes), first, static_cast<std::uint32_t>(expected.size()), 0});
    for (std::uint32_t k = 0; k < run; ++k) expected.emplace_back(seeds.back().node, first + k);
  }
  Bindings b;
  b.ray_nodes = buffer_of(std::vector<Node>(nodes, {{0, 0, 0}, 1, {0, 0, 1}, 4, 1e30F}));
  b.spheres = buffer_of(std::vector<glm::vec4>(objects, {0, 0, 0, 1}));
  b.seeds = buffer_of(seeds);
  const auto count = static_cast<std::uint32_t>(seeds.size());
  const Tested got = test_pairs(kernel, b, {kind, 1, 0, nodes, candidates, offset, count, 0});
  expected.erase(expected.begin(), expected.begin() + offset);
  expected.resize(candidates);
  EXPECT_TRUE(got.pairs == expected);
  EXPECT_TRUE(std::all_of(got.survives.begin(), got.survives.end(), [](auto s) { return s == 1; }));
}

}  // namespace
}  // namespace sheaf::test
