// SPDX-License-Identifier: MIT
// Every strategy's hits: against a search in double precision over all triangles, and against each other bit for bit.
//
// Tolerances, in units of ε = 2^-20 · S, S the largest coordinate of scene and rays. Kernels work on corners minus
// origin (each rounded once, at most 2S) and shear them by products of two factors rounded a few times, so that a
// sheared corner lies within 8·2^-24·2S = ε of where it should. Hence:
//   a hit or miss may differ from the true one only where the ray passes within ε of the triangle's outline;
//   corners moved by ε change a barycentric weight by 2ε/h at most, h the least height of the triangle as the ray sees
//   it, so t may be off by ε and 4ε/h of the triangle's extent along the ray, and never by more than ε and that extent.
#include <bit>
#include <cmath>

#include "device_world.hpp"

namespace sheaf::test {
namespace {

using Rays = std::vector<TestRay>;
constexpr double far_off = std::numeric_limits<double>::infinity();

struct True {  // one ray against one triangle, double precision
  double t = 0;
  double clearance = 0;  // from the outline, measured across the ray; negative outside
  double t_error = 0;    // what t may be off by
};

double cross2(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

double segment_distance(const glm::dvec2& a, const glm::dvec2& b) {  // of the origin
  const glm::dvec2 ab = b - a;
  const double length2 = glm::dot(ab, ab);
  const double along = length2 > 0 ? std::clamp(-glm::dot(a, ab) / length2, 0.0, 1.0) : 0;
  return glm::length(a + ab * along);
}

True measure(const TestRay& ray, const Corners& triangle, double epsilon) {
  const glm::dvec3 d = glm::normalize(glm::dvec3(ray.direction)), u = square_to(d), v = glm::cross(d, u), o(ray.origin);
  glm::dvec2 p[3];
  double depth[3];
  const glm::vec3* corner[3] = {&triangle.a, &triangle.b, &triangle.c};
  for (int k = 0; k < 3; ++k) {
    const glm::dvec3 q = glm::dvec3(*corner[k]) - o;
    p[k] = {glm::dot(q, u), glm::dot(q, v)};
    depth[k] = glm::dot(q, d);
  }
  const double w[3] = {cross2(p[1], p[2]), cross2(p[2], p[0]), cross2(p[0], p[1])};
  const bool inside = (w[0] >= 0 && w[1] >= 0 && w[2] >= 0) || (w[0] <= 0 && w[1] <= 0 && w[2] <= 0);
  const double outline =
      std::min({segment_distance(p[0], p[1]), segment_distance(p[1], p[2]), segment_distance(p[2], p[0])});
  True result;
  result.clearance = inside ? outline : -outline;
  const double area = w[0] + w[1] + w[2];
  const double longest = std::max({glm::length(p[1] - p[0]), glm::length(p[2] - p[1]), glm::length(p[0] - p[2])});
  const double height = std::abs(area) / std::max(longest, 1e-300);
  const double lo = std::min({depth[0], depth[1], depth[2]}), hi = std::max({depth[0], depth[1], depth[2]});
  result.t = area != 0 ? (w[0] * depth[0] + w[1] * depth[1] + w[2] * depth[2]) / area : depth[0];
  result.t_error = epsilon + (hi - lo) * std::min(4 * epsilon / std::max(height, 1e-300), 1.0);
  // The true t of a nearly edge-on triangle, of a ray just outside it, may lie anywhere: hold it to the triangle.
  result.t = std::clamp(result.t, lo, hi);
  return result;
}

struct Subject {
  std::string name;
  Mesh mesh;
  Rays rays;
};

double largest_coordinate(const std::vector<Corners>& triangles, const Rays& rays) {
  double largest = 0;
  auto add = [&](const glm::vec3& p) {
    largest = std::max<double>({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  };
  for (const auto& t : triangles) {
    add(t.a);
    add(t.b);
    add(t.c);
  }
  for (const auto& ray : rays) add(ray.origin);
  return largest;
}

struct Hit {
  bool any;
  float t;
  std::uint32_t triangle;
};

Hit unpack(std::uint64_t word) {
  return {word != ~0ULL, std::bit_cast<float>(static_cast<std::uint32_t>(word >> 32U)),
          static_cast<std::uint32_t>(word)};
}

/// The nearest hit is there and is a hit; `any`: some hit is there if there is one.
void expect_true(const std::vector<std::uint64_t>& hits, const Rays& rays, const std::vector<Corners>& triangles,
                 bool any) {
  const double epsilon = std::exp2(-20) * largest_coordinate(triangles, rays);
  std::size_t found = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Hit hit = unpack(hits[i]);
    double clear_t = far_off, clear_error = 0;
    for (const auto& triangle : triangles) {
      const True truth = measure(rays[i], triangle, epsilon);
      if (truth.clearance <= epsilon || truth.t - truth.t_error < rays[i].tmin ||
          truth.t + truth.t_error > rays[i].tmax)
        continue;
      if (truth.t + truth.t_error < clear_t + clear_error) {
        clear_t = truth.t;
        clear_error = truth.t_error;
      }
    }
    if (!hit.any) {
      ASSERT_EQ(clear_t, far_off) << "ray " << i << " misses what it clearly hits";
      continue;
    }
    ++found;
    ASSERT_LT(hit.triangle, triangles.size());
    ASSERT_GE(hit.t, rays[i].tmin);
    ASSERT_LE(hit.t, rays[i].tmax);
    const True truth = measure(rays[i], triangles[hit.triangle], epsilon);
    ASSERT_GE(truth.clearance, -epsilon) << "ray " << i << " hits what it clearly misses, triangle " << hit.triangle;
    ASSERT_NEAR(hit.t, truth.t, truth.t_error) << "ray " << i << ", triangle " << hit.triangle;
    if (any) continue;
    ASSERT_LE(hit.t, clear_t + clear_error) << "ray " << i << ": a nearer hit was passed over";
  }
  EXPECT_GT(found, rays.size() / 50);
  EXPECT_LT(found, rays.size());
}

Mesh mesh_of(const std::vector<Corners>& triangles) {
  Mesh mesh;
  for (const auto& t : triangles) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), {t.a, t.b, t.c});
    mesh.triangles.emplace_back(first, first + 1, first + 2);
  }
  return mesh;
}

/// Rays from within and outside; a third aimed at corners, a third at edges, exactly as far as floats go.
Rays aimed_rays(Dice& dice, const std::vector<Corners>& triangles, double size, std::size_t count) {
  Rays rays(count);
  for (auto& ray : rays) {
    const auto& t = triangles[dice.below(static_cast<std::uint32_t>(triangles.size()))];
    const glm::dvec3 a(t.a), b(t.b), c(t.c);
    const std::uint32_t where = dice.below(3);
    const double along = dice.unit();
    const glm::dvec3 target = where == 0 ? a : where == 1 ? glm::mix(a, b, along) : dice.cube() * size + 0.1 * c;
    ray.origin = glm::vec3(dice.cube() * size * 1.5);
    const glm::dvec3 way = target - glm::dvec3(ray.origin);
    if (glm::length(way) < 1e-3 * size) continue;
    ray.direction = glm::vec3(glm::normalize(way));
    if (dice.below(4) == 0) ray.tmin = static_cast<float>(glm::length(way) * dice.range(0, 1.2));
    if (dice.below(4) == 0) ray.tmax = ray.tmin + static_cast<float>(glm::length(way) * dice.range(0, 2));
  }
  return rays;
}

std::vector<Corners> random_triangles(Dice& dice, std::size_t count, double spread, double size) {
  std::vector<Corners> triangles;
  while (triangles.size() < count) {
    const glm::dvec3 place = dice.cube() * spread;
    auto corner = [&] { return glm::vec3(place + dice.cube() * size); };
    triangles.push_back({corner(), corner(), corner()});
    if (dice.below(10) == 0)
      triangles.back().c = triangles.back().b + glm::vec3(dice.cube() * size * 1e-5);  // a needle
    if (dice.below(30) == 0) triangles.back().c = triangles.back().a;                  // no area
  }
  return triangles;
}

std::vector<Subject> subjects() {
  std::vector<Subject> all;
  auto add = [&](const char* name, std::size_t count, double spread, double size, std::size_t rays) {
    Dice dice(static_cast<std::uint32_t>(all.size()) + 40);
    const auto triangles = random_triangles(dice, count, spread, size);
    all.push_back({name, mesh_of(triangles), aimed_rays(dice, triangles, spread + size, rays)});
  };
  add("soup", 300, 1, 0.3, 6000);
  add("tiny soup", 100, 1e-6, 3e-7, 2000);
  add("huge soup", 100, 1e6, 3e5, 2000);
  add("crumbs", 500, 1, 0.03, 4000);
  add("one triangle", 1, 0.5, 1, 500);
  // Parallel rays from all over: bundles as narrow as can be that cross everything, and so give up.
  Dice far(77);
  const auto confetti = random_triangles(far, 3000, 1, 0.02);
  Rays parallel(640);
  for (auto& ray : parallel) {
    ray.origin = glm::vec3(far.cube());
    ray.direction = glm::normalize(glm::vec3(0.3F, -0.9F, 0.2F));
  }
  all.push_back({"parallel", mesh_of(confetti), parallel});
  // Two faces in one place and a fan with a shared corner: ties go to the lower triangle.
  Dice dice(9);
  std::vector<Corners> fan;
  for (int k = 0; k < 12; ++k) {
    const double from = k * 0.5235987755982988, to = from + 0.5235987755982988;
    const Corners blade{{0, 0, 0}, {std::cos(from), std::sin(from), 0}, {std::cos(to), std::sin(to), 0}};
    fan.push_back(blade);
    if (k % 3 == 0) fan.push_back({blade.b, blade.c, blade.a});
  }
  all.push_back({"fan", mesh_of(fan), aimed_rays(dice, fan, 0.9, 3000)});
  return all;
}

SceneBuilder scene_of(const Mesh& mesh) {
  SceneBuilder builder;
  builder.mesh(mesh, 0);
  return builder;
}

WorldOptions options_for(Strategy strategy, std::size_t rays, std::uint64_t memory_mib = 1024) {
  return {strategy, SortPolicy::on, static_cast<std::uint32_t>(rays), memory_mib};
}

TEST(DeviceIntersect, BruteForceAgreesWithDoublePrecision) {
  for (const auto& subject : subjects()) {
    SCOPED_TRACE(subject.name);
    DeviceWorld world(scene_of(subject.mesh), options_for(Strategy::brute, subject.rays.size()));
    const auto triangles = world.triangles();
    expect_true(world.trace(gpu::KIND_REFLECTION, subject.rays), subject.rays, triangles, false);
    EXPECT_EQ(world.stat(gpu::KIND_REFLECTION, gpu::STAT_RAY_TRIANGLE), subject.rays.size() * triangles.size());
    expect_true(world.trace(gpu::KIND_SHADOW, subject.rays), subject.rays, triangles, true);
  }
}

TEST(DeviceIntersect, StrategiesGiveTheSameBytes) {
  for (const auto& subject : subjects()) {
    DeviceWorld oracle(scene_of(subject.mesh), options_for(Strategy::brute, subject.rays.size()));
    const auto nearest = oracle.trace(gpu::KIND_REFLECTION, subject.rays);
    const auto shadowed = oracle.trace(gpu::KIND_SHADOW, subject.rays);
    const auto triangles = oracle.triangles();
    for (const auto strategy :
         {Strategy::bvh, Strategy::hybrid, Strategy::rsh, Strategy::crsh, Strategy::frustum, Strategy::classify}) {
      SCOPED_TRACE(subject.name + std::string(", ") + name_of(strategy));
      DeviceWorld world(scene_of(subject.mesh), options_for(strategy, subject.rays.size(), 4));
      ASSERT_GE(world.memory().capacity, subject.rays.size());
      EXPECT_EQ(world.trace(gpu::KIND_REFLECTION, subject.rays), nearest);
      EXPECT_EQ(world.trace(gpu::KIND_PRIMARY, subject.rays), nearest);
      const auto shadows = world.trace(gpu::KIND_SHADOW, subject.rays);
      std::size_t different = 0;
      for (std::size_t i = 0; i < shadows.size(); ++i)
        different += (shadows[i] == ~0ULL) != (shadowed[i] == ~0ULL) ? 1 : 0;
      EXPECT_EQ(different, 0U) << "shadow rays blocked in one and not in the other";
      expect_true(shadows, subject.rays, triangles, true);
    }
  }
}

// List lengths round a bundle, a block and none at all, with slots between that hold no ray.
TEST(DeviceIntersect, ListsOfAnyLengthAreTracedWhole) {
  const auto all = subjects();
  const auto& subject = all.front();
  DeviceWorld oracle(scene_of(subject.mesh), options_for(Strategy::brute, subject.rays.size()));
  const auto nearest = oracle.trace(gpu::KIND_REFLECTION, subject.rays);
  for (const auto strategy : {Strategy::brute, Strategy::bvh, Strategy::hybrid, Strategy::rsh, Strategy::crsh,
                              Strategy::frustum, Strategy::classify}) {
    DeviceWorld world(scene_of(subject.mesh), options_for(strategy, subject.rays.size()));
    for (const std::size_t n : {0, 1, 2, 7, 8, 9, 63, 64, 65, 127, 128, 129, 1023, 1024, 1025, 2049}) {
      Rays rays(subject.rays.begin(), subject.rays.begin() + static_cast<std::ptrdiff_t>(n));
      for (std::size_t i = 0; i < n; ++i)
        if (i % 5 == 3) rays[i].pixel = gpu::NO_INDEX;
      const auto hits = world.trace(gpu::KIND_REFLECTION, rays);
      for (std::size_t i = 0; i < n; ++i)
        ASSERT_EQ(hits[i], i % 5 == 3 ? 0xABABABABABABABABULL : nearest[i])
            << name_of(strategy) << ", ray " << i << " of " << n;
    }
  }
}

}  // namespace
}  // namespace sheaf::test
