// SPDX-License-Identifier: MIT
// Spheres and cones over rays, and what they cull.
#include "bounds_search.hpp"

namespace sheaf::test {
namespace {

TEST(Bounds, AnglesErrByLessThanTheyClaim) {
  Dice dice(1);
  Real worst = 0, sum = 0;
  constexpr int count = 400000;
  for (int i = 0; i < count; ++i) {
    const Vec axis = dice.direction();
    const vec3 a = unit_float(axis);
    const vec3 b = unit_float(dice.turned(axis, 3.14159265358979L * dice.power(-9, 0)));
    const Real angle = exact_angle(a, b);
    const Real share = std::abs(shader::angle_between(a, b) - angle) / (4 * ulp + 6 * ulp * angle);
    worst = std::max(worst, share);
    sum += share;
  }
  EXPECT_LE(worst, 1);
  std::printf("angle_between: %.3Lf of its bound at worst, %.3Lf on the average\n", worst, sum / count);
}

std::vector<shader::Node> random_rays(Dice& dice, Real size, std::size_t count) {
  std::vector<shader::Node> rays(count);
  const Vec place = dice.cube() * size, axis = dice.direction();
  const Real spread = size * dice.power(-7, 0), cone = dice.power(-8, 0.15L);
  for (auto& ray : rays) {
    ray.centre = vec3(place + dice.cube() * spread);
    ray.axis = unit_float(dice.turned(axis, cone * dice.range(0, 1)));
    ray.tmax = std::numeric_limits<float>::infinity();
  }
  return rays;
}

bool holds_rays(const shader::Node& node, const std::vector<shader::Node>& rays, std::size_t first, std::size_t last) {
  for (std::size_t i = first; i < std::min(last, rays.size()); ++i) {
    const bool in_cone = node.angle >= 1.5707963F || exact_angle(node.axis, rays[i].axis) <= node.angle;
    if (!in_cone || !(glm::length(Vec(rays[i].centre) - Vec(node.centre)) <= node.radius)) return false;
  }
  return true;
}

TEST(Bounds, NodesOverRaysHoldThem) {
  Search search("node over rays, three levels (radius against the farthest origin)");
  over_decades(400, [&](Dice& dice, int decade, Real size) {
    const auto rays = random_rays(dice, size, 64);
    auto level = rays;
    for (std::size_t span = 4; span <= 64; span *= 4) {
      std::vector<shader::Node> above;
      for (std::size_t i = 0; i < level.size(); i += 4) above.push_back(shader::node_over(&level[i], 4));
      level = above;
      bool good = true;
      for (std::size_t n = 0; n < level.size(); ++n) good &= holds_rays(level[n], rays, n * span, (n + 1) * span);
      search.add(decade, good);
      if (span > 4) continue;
      Real farthest = 0;
      for (std::size_t i = 0; i < 4; ++i)
        farthest = std::max(farthest, glm::length(Vec(rays[i].centre) - Vec(level[0].centre)));
      if (farthest > 0) search.looseness(decade, level[0].radius / farthest - 1);
    }
  });
  search.report();
}

bool ray_meets_sphere(const shader::Node& ray, const Vec& centre, Real radius) {
  const Vec v = centre - Vec(ray.centre), d = glm::normalize(Vec(ray.axis));
  const Real along = std::clamp(glm::dot(v, d), Real(0), Real(ray.tmax));
  return glm::length(v - d * along) <= radius;
}

/// Between the rays' mean direction and the furthest of theirs.
Real half_angle(const std::vector<shader::Node>& rays) {
  Vec sum(0);
  for (const auto& ray : rays) sum += Vec(ray.axis);
  Real widest = 0;
  for (const auto& ray : rays)
    widest = std::max(widest, std::atan2(glm::length(glm::cross(sum, Vec(ray.axis))), glm::dot(sum, Vec(ray.axis))));
  return widest;
}

TEST(Bounds, BundlesHoldTheirRaysAndWideOnesAreIncoherent) {
  Search search("bundle of rays (radius against the farthest origin)");
  over_decades(4000, [&](Dice& dice, int decade, Real size) {
    const auto rays = random_rays(dice, size, 1 + static_cast<std::size_t>(dice.range(0, 64)));
    const auto [node, incoherent] = shader::bundle_over(rays, 0.1F);
    search.add(decade, holds_rays(node, rays, 0, rays.size()));
    if (const Real angle = half_angle(rays); angle > 0.1L) {
      EXPECT_TRUE(incoherent);
    } else if (angle < 0.01L) {
      EXPECT_FALSE(incoherent);
    }
    Real farthest = 0;
    for (const auto& ray : rays) farthest = std::max(farthest, glm::length(Vec(ray.centre) - Vec(node.centre)));
    if (farthest > 0) search.looseness(decade, node.radius / farthest - 1);
  });
  search.report();
}

TEST(Bounds, BundlesOfOneDirectionAndOfAllAreBounded) {
  const auto bundle_of = [](std::size_t count, auto&& ray) {
    std::vector<shader::Node> rays(count);
    for (std::size_t i = 0; i < count; ++i) ray(rays[i], static_cast<int>(i));
    const auto bundle = shader::bundle_over(rays, 0.1F);
    EXPECT_TRUE(holds_rays(bundle.node, rays, 0, count));
    return bundle;
  };
  const vec3 axis = unit_float({0.3L, -0.5L, 0.8L});
  for (const std::size_t count : {1U, 2U, 8U, 63U, 64U}) {
    const auto equal = bundle_of(count, [&](auto& ray, int) { ray.centre = {1, 2, 3}, ray.axis = axis; });
    EXPECT_EQ(equal.node.radius, 0);
    EXPECT_LT(equal.node.angle, 2e-6F);
    EXPECT_FALSE(equal.incoherent);
    const auto ulps = bundle_of(count, [&](auto& ray, int i) {
      ray.centre = {i % 2 == 0 ? 1e7F : std::nextafter(1e7F, 1e9F), 1, 1e-7F};
      ray.axis = axis;
      if (i % 2 == 1) ray.axis.x = std::nextafter(axis.x, 2.0F);
    });
    EXPECT_FALSE(ulps.incoherent);
    if (count < 2) continue;
    EXPECT_TRUE(bundle_of(count, [&](auto& ray, int i) { ray.axis = i % 2 == 0 ? axis : -axis; }).incoherent);
    EXPECT_TRUE(bundle_of(count, [&](auto& ray, int i) { ray.axis[i % 3] = i % 6 < 3 ? 1.0F : -1.0F; }).incoherent);
    // Within the widest, but to both sides of an axis: no slab bounds it.
    EXPECT_TRUE(bundle_of(count, [&](auto& ray, int i) {
                  ray.axis = unit_float({i % 2 == 0 ? 0.05L : -0.05L, 0, 1});
                }).incoherent);
  }
}

TEST(Bounds, NoSphereIsCulledThatARayMeets) {
  Search search("node against sphere (radius that is culled, short of the distance, for one ray)");
  over_decades(12000, [&](Dice& dice, int decade, Real size) {
    const auto rays = random_rays(dice, size, 4);
    const auto node = shader::node_over(rays.data(), 4);
    const auto& aimed = rays[0];
    const Vec along = glm::normalize(Vec(aimed.axis)), across = glm::normalize(glm::cross(along, dice.direction()));
    const Real distance = size * dice.power(-6, 1), radius = size * dice.power(-6, 1);
    // Just touched, by a share of the radius as small as floats can tell.
    const vec3 centre(Vec(aimed.centre) + along * distance +
                      across * (radius * (1 + dice.range(-1, 1) * dice.power(-8, -1))));
    const auto r = static_cast<float>(radius);
    bool met = false;
    for (const auto& ray : rays) met |= ray_meets_sphere(ray, Vec(centre), r);
    search.add(decade, !met || shader::meets_sphere(node, centre, r));
    if (!search.counts(decade) || distance < radius) return;
    const Real true_distance =
        glm::length(Vec(centre) - Vec(aimed.centre) - along * glm::dot(Vec(centre) - Vec(aimed.centre), along));
    float lo = 0, hi = r * 2;  // the least radius that is not culled
    for (int k = 0; k < 40; ++k) (shader::meets_sphere(aimed, centre, 0.5F * (lo + hi)) ? hi : lo) = 0.5F * (lo + hi);
    search.looseness(decade, (true_distance - hi) / (distance + true_distance));
  });
  search.report();
}

}  // namespace
}  // namespace sheaf::test
