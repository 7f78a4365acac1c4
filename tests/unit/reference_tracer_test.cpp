// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <random>

#include "reference/tracer.hpp"
#include "scene_builder.hpp"

namespace sheaf::reference {
namespace {

using Triangles = std::vector<ReferenceTriangle>;

glm::dvec3 random_point(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  const double x = unit(random), y = unit(random), z = unit(random);
  return {x, y, z};
}

bool accept_all(const Hit&) { return true; }

Hit closest_of_all(const Ray& ray, const Triangles& triangles) {
  double least = std::numeric_limits<double>::infinity();
  std::vector<Hit> hits;
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    Hit hit;
    hit.triangle = i;
    if (!intersect(ray, triangles[i], hit)) continue;
    hits.push_back(hit);
    least = std::min(least, hit.t);
  }
  for (const Hit& hit : hits) {
    if (hit.t <= std::nextafter(least, std::numeric_limits<double>::infinity())) return hit;
  }
  return {};
}

Triangles soup(std::size_t count, double scale, const glm::dvec3& shift) {
  std::mt19937 random(5);
  Triangles triangles;
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec3 at = random_point(random),
                     size(std::pow(10, std::uniform_real_distribution<double>(-4, 0)(random)));
    ReferenceTriangle t{};
    for (glm::dvec3& v : t.v) v = (at + size * random_point(random)) * scale + shift;
    triangles.push_back(t);
    if (i % 5 == 0) triangles.push_back(t);  // twins: a tie at every hit
  }
  return triangles;
}

class TracerTest : public testing::TestWithParam<std::pair<double, double>> {};
INSTANTIATE_TEST_SUITE_P(ScaleAndShift, TracerTest,
                         testing::Values(std::pair{1.0, 0.0}, std::pair{1e-6, 0.0}, std::pair{1e6, 0.0},
                                         std::pair{1.0, 1e4}));

TEST_P(TracerTest, TreeFindsWhatTryingAllFinds) {
  const auto [scale, shift] = GetParam();
  const Triangles triangles = soup(2000, scale, glm::dvec3(shift));
  const Tracer tracer(triangles);
  std::mt19937 random(9);
  int hits = 0;
  for (int i = 0; i < 3000; ++i) {
    Ray ray{random_point(random) * (scale * (i % 2 ? 1 : 3)) + shift, glm::normalize(random_point(random))};
    if (i % 10 == 0) ray.direction = glm::dvec3(i % 20 ? 1 : 0, i % 20 ? 0 : -1, 0);
    if (i % 3 == 0) ray.tmax = scale;
    Tests tests;
    const Hit expected = closest_of_all(ray, triangles), found = tracer.closest(ray, accept_all, tests);
    ASSERT_EQ(found.triangle, expected.triangle) << "ray " << i;
    EXPECT_EQ(found.t, expected.t);
    hits += found.triangle != none;
    std::size_t all = 0;
    tracer.for_each_hit(
        ray, [&](const Hit&) { return ++all, true; }, tests);
    std::size_t expected_all = 0;
    for (const ReferenceTriangle& t : triangles) {
      Hit hit;
      expected_all += intersect(ray, t, hit) ? 1 : 0;
    }
    EXPECT_EQ(all, expected_all);
  }
  EXPECT_GT(hits, 500);
}

TEST(Tracer, TiesGoToTheLowestTriangle) {
  ReferenceTriangle t{};
  t.v[0] = {-1, -1, 0.1};
  t.v[1] = {1, -1, 0.2};
  t.v[2] = {0, 1, 0.7};
  const Triangles triangles(1000, t);
  const Tracer tracer(triangles);
  Tests tests;
  const Ray ray{{0.1, 0.05, 5}, {0, 0, -1}};
  EXPECT_EQ(tracer.closest(ray, accept_all, tests).triangle, 0u);
  EXPECT_EQ(tracer
                .closest(
                    ray, [](const Hit& h) { return h.triangle >= 417; }, tests)
                .triangle,
            417u);
}

// A closed ball of triangles seen from inside: through every vertex and along every edge, nothing leaks.
TEST(Tracer, ClosedMeshIsWatertight) {
  const int rings = 24, sectors = 37;
  const auto at = [&](int ring, int sector) {
    const double polar = 3.14159265358979 * ring / rings, around = 6.28318530717959 * (sector % sectors) / sectors;
    return ring == 0 ? glm::dvec3(0, 0, 1)
           : ring == rings
               ? glm::dvec3(0, 0, -1)
               : glm::dvec3(std::sin(polar) * std::cos(around), std::sin(polar) * std::sin(around), std::cos(polar));
  };
  Triangles triangles;
  for (int r = 0; r < rings; ++r) {
    for (int s = 0; s < sectors; ++s) {
      triangles.push_back({{at(r, s), at(r + 1, s), at(r + 1, s + 1)}, 0, 0, 0});
      triangles.push_back({{at(r, s), at(r + 1, s + 1), at(r, s + 1)}, 0, 0, 0});
    }
  }
  const Tracer tracer(triangles);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  Tests tests;
  int leaks = 0;
  for (const ReferenceTriangle& t : triangles) {
    for (int i = 0; i < 60; ++i) {
      const glm::dvec3 origin = 0.5 * random_point(random);
      const double along = unit(random);
      const glm::dvec3 target = i % 3 == 0 ? t.v[i % 9 / 3] : glm::mix(t.v[i % 3], t.v[(i + 1) % 3], along);
      leaks += tracer.closest({origin, glm::normalize(target - origin)}, accept_all, tests).triangle == none;
    }
  }
  EXPECT_EQ(leaks, 0);
}

TEST(Tracer, DegenerateTrianglesAreNeverHit) {
  ReferenceTriangle point{}, line{};
  line.v[0] = {-1, 0, 0};
  line.v[1] = {1, 0, 0};
  line.v[2] = {3, 0, 0};
  Hit hit;
  EXPECT_FALSE(intersect({{0, 0, 1}, {0, 0, -1}}, point, hit));
  EXPECT_FALSE(intersect({{0, 0, 1}, {0, 0, -1}}, line, hit));
  ReferenceTriangle flat{};
  flat.v[1] = {1, 0, 0};
  flat.v[2] = {0, 1, 0};
  EXPECT_FALSE(intersect({{-1, 0.1, 0}, {1, 0, 0}}, flat, hit));  // in its plane
  EXPECT_TRUE(intersect({{0, 0, 1}, {0, 0, -1}}, flat, hit));     // through a vertex
  EXPECT_EQ(hit.t, 1);
}

}  // namespace
}  // namespace sheaf::reference
