// SPDX-License-Identifier: MIT
// Bounds of the shaders (sphere, cone, box, offset) by random search: their operations in single precision, the truth
// in long double, sizes from 1e-30 to 1e30. Every search counts violations a decade; none may be where squares of sizes
// are floats. How loose a bound is on the average, and at the least, is printed and recorded.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "bounds_shaders.hpp"

namespace sheaf::test {
namespace {

using Real = long double;
using Vec = glm::vec<3, Real>;
using glm::vec3;
constexpr Real ulp = 0x1p-24L;

class Dice {
 public:
  explicit Dice(unsigned seed) : engine_(seed) {}
  Real range(Real lo, Real hi) { return lo + (hi - lo) * unit_(engine_); }
  Real power(Real lo, Real hi) { return std::pow(Real(10), range(lo, hi)); }
  Vec cube() { return {range(-1, 1), range(-1, 1), range(-1, 1)}; }
  Vec direction() {
    for (;;) {
      const Vec v = cube();
      const Real size = glm::length(v);
      if (size > 0.1L && size <= 1) return v / size;
    }
  }
  /// At `angle` from an axis.
  Vec turned(const Vec& axis, Real angle) {
    const Vec side = glm::normalize(glm::cross(axis, direction()));
    return axis * std::cos(angle) + side * std::sin(angle);
  }

 private:
  std::mt19937_64 engine_;
  std::uniform_real_distribution<double> unit_{0, 1};
};

vec3 unit_float(const Vec& v) { return {glm::normalize(v)}; }

/// Violations by decade of size, and the average of a measure of looseness over the decades that count.
class Search {
 public:
  /// Decades from `least` to `greatest` must be clean, and count for the looseness.
  explicit Search(const char* name, int least = -12, int greatest = 12)
      : name_(name), least_decade_(least), greatest_decade_(greatest) {}
  [[nodiscard]] bool counts(int decade) const { return decade >= least_decade_ && decade <= greatest_decade_; }
  void add(int decade, bool holds) {
    ++tried_[decade];
    violations_[decade] += holds ? 0 : 1;
  }
  void looseness(int decade, Real value) {
    if (!counts(decade)) return;
    sum_ += value;
    least_ = std::min(least_, value);
    ++count_;
  }
  void report() const {
    int lo = 0, hi = 0;
    for (const auto& [decade, bad] : violations_)
      if (counts(decade)) {
        EXPECT_EQ(bad, 0U) << name_ << ": of " << tried_.at(decade) << " of size 1e" << decade;
      }
    while (lo > -30 && clean(lo - 3)) lo -= 3;
    while (hi < 30 && clean(hi + 3)) hi += 3;
    std::printf("%s: holds from 1e%d to 1e%d", name_, lo, hi);
    if (count_ > 0)
      std::printf("; looseness %.3Lg on the average, %.3Lg at the least", sum_ / static_cast<Real>(count_), least_);
    std::printf("\n");
    testing::Test::RecordProperty("holds_from", lo);
    testing::Test::RecordProperty("holds_to", hi);
    if (count_ > 0)
      testing::Test::RecordProperty("looseness", std::to_string(static_cast<double>(sum_ / static_cast<Real>(count_))));
  }

 private:
  [[nodiscard]] bool clean(int decade) const {
    const auto found = violations_.find(decade);
    return found != violations_.end() && found->second == 0;
  }
  const char* name_;
  int least_decade_, greatest_decade_;
  std::map<int, std::size_t> tried_, violations_;
  Real sum_ = 0, least_ = 1e30L;
  std::size_t count_ = 0;
};

template <typename Body>
void over_decades(std::size_t times, Body body) {
  for (int decade = -30; decade <= 30; decade += 3) {
    Dice dice(static_cast<unsigned>(decade + 1000));
    for (std::size_t i = 0; i < times; ++i) body(dice, decade, std::pow(Real(10), decade));
  }
}

Real exact_angle(const vec3& a, const vec3& b) {
  return std::atan2(glm::length(glm::cross(Vec(a), Vec(b))), glm::dot(Vec(a), Vec(b)));
}

// ---- rays' nodes ----
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

// ---- triangles ----
struct Shot {  // a ray at a triangle
  vec3 corner[3];
  vec3 origin, direction;
  float box_pad = 0;
};

float box_pad_of(const Shot& shot) {  // DeviceScene::choose_pad
  float largest = 1e-30F;
  for (const auto& p : {shot.corner[0], shot.corner[1], shot.corner[2], shot.origin})
    for (int c = 0; c < 3; ++c) largest = std::max(largest, std::abs(p[c]));
  return std::exp2(std::ceil(std::log2(largest)) - 21.0F);
}

/// At a point of the triangle or, `beside` an edge, just past it by a share of what rounding may do.
Shot random_shot(Dice& dice, Real size, bool beside) {
  Shot shot;
  const Vec place = dice.cube() * size;
  const Real extent = size * dice.power(-4, 0);
  for (auto& corner : shot.corner) corner = vec3(place + dice.cube() * extent);
  if (dice.range(0, 1) < 0.3L) {  // in a plane of the axes, along its box's sides
    const int flat = static_cast<int>(dice.range(0, 3));
    for (auto& corner : shot.corner) corner[flat] = shot.corner[0][flat];
    shot.corner[1][(flat + 1) % 3] = shot.corner[0][(flat + 1) % 3];
    shot.corner[2][(flat + 2) % 3] = shot.corner[0][(flat + 2) % 3];
  }
  if (dice.range(0, 1) < 0.2L) shot.corner[2] = vec3(Vec(shot.corner[1]) + dice.cube() * extent * dice.power(-5, -1));
  const Real u = dice.range(0, 1), v = beside ? 0 : dice.range(0, 1 - u);
  const Vec a(shot.corner[0]), b(shot.corner[1]), c(shot.corner[2]);
  Vec target = a + (b - a) * u + (c - a) * v;
  if (beside) target -= glm::normalize(c - a) * (size * ulp * dice.range(0, 12));
  shot.origin = vec3(dice.cube() * size);
  Vec way = target - Vec(shot.origin);
  if (dice.range(0, 1) < 0.1L) way[static_cast<int>(dice.range(0, 3))] *= dice.power(-25, -5);  // nearly along a plane
  shot.direction = unit_float(way);
  shot.box_pad = box_pad_of(shot);
  return shot;
}

struct Truth {
  bool inside;
  Real clearance, t;  // distance from the outline across the ray
  Real largest;       // coordinate of corner − origin
};

Truth truth_of(const Shot& shot) {
  const Vec d = glm::normalize(Vec(shot.direction));
  const Vec u = glm::normalize(glm::cross(d, std::abs(d.x) < 0.6L ? Vec(1, 0, 0) : Vec(0, 1, 0))), v = glm::cross(d, u);
  glm::vec<2, Real> p[3];
  Real depth[3], w[3];
  Truth truth{true, 1e30L, 0, 0};
  for (int k = 0; k < 3; ++k) {
    const Vec q = Vec(shot.corner[k]) - Vec(shot.origin);
    p[k] = {glm::dot(q, u), glm::dot(q, v)};
    depth[k] = glm::dot(q, d);
    for (int c = 0; c < 3; ++c) truth.largest = std::max(truth.largest, std::abs(q[c]));
  }
  auto cross2 = [](const auto& a, const auto& b) { return a.x * b.y - a.y * b.x; };
  for (int k = 0; k < 3; ++k) w[k] = cross2(p[(k + 1) % 3], p[(k + 2) % 3]);
  const Real area = w[0] + w[1] + w[2];
  for (int k = 0; k < 3; ++k) {
    truth.inside &= w[k] * area >= 0;
    const auto edge = p[(k + 2) % 3] - p[(k + 1) % 3];
    truth.clearance = std::min(truth.clearance, std::abs(w[k]) / std::max(glm::length(edge), Real(1e-4000L)));
  }
  truth.t = (w[0] * depth[0] + w[1] * depth[1] + w[2] * depth[2]) / area;
  return truth;
}

TEST(Bounds, SpheresOfTrianglesHoldTheirCorners) {
  Search search("sphere of a triangle (padded radius against the farthest corner)");
  over_decades(20000, [&](Dice& dice, int decade, Real size) {
    const Shot shot = random_shot(dice, size, false);
    const glm::vec4 sphere = shader::triangle_sphere(shot.corner[0], shot.corner[1], shot.corner[2]);
    const float radius = shader::padded_radius(sphere.w, shot.box_pad);
    Real farthest = 0;
    for (const auto& corner : shot.corner) farthest = std::max(farthest, glm::length(Vec(corner) - Vec(vec3(sphere))));
    search.add(decade, farthest <= radius);
    search.looseness(decade, radius / farthest - 1);
  });
  search.report();
}

TEST(Bounds, WhatIsHitMeetsItsSphere) {
  Search search("hits past an edge within the sphere");
  over_decades(20000, [&](Dice& dice, int decade, Real size) {
    const Shot shot = random_shot(dice, size, true);
    if (!shader::intersect(shot.origin, shot.direction, shot.corner, shot.box_pad).hit) return;
    const glm::vec4 sphere = shader::triangle_sphere(shot.corner[0], shot.corner[1], shot.corner[2]);
    shader::Node ray{shot.origin, 0, shot.direction, 0, std::numeric_limits<float>::infinity()};
    search.add(decade, shader::meets_sphere(ray, vec3(sphere), shader::padded_radius(sphere.w, shot.box_pad)));
  });
  search.report();
}

/// The box alone may lose no hit of the edge functions: were it endless, they would be all there is.
TEST(Bounds, NoHitIsLostToABox) {
  Search search("box of a triangle (share of the padding that is not needed)");
  over_decades(20000, [&](Dice& dice, int decade, Real size) {
    Shot shot = random_shot(dice, size, dice.range(0, 1) < 0.5L);
    const Truth truth = truth_of(shot);
    auto is_hit = [&](float pad) { return shader::intersect(shot.origin, shot.direction, shot.corner, pad).hit; };
    if (!(truth.t > 64 * ulp * truth.largest) || !is_hit(1000 * shot.box_pad)) return;
    search.add(decade, is_hit(shot.box_pad));
    float share = 0, upper = 1;  // least share of the padding that lets it be hit
    if (!is_hit(0)) {
      for (int k = 0; k < 12; ++k)
        (is_hit(shot.box_pad * 0.5F * (share + upper)) ? upper : share) = 0.5F * (share + upper);
      share = upper;
    }
    search.looseness(decade, 1 - share);
  });
  search.report();
}

// ---- origins ----
/// Away from the surface, straight and grazing.
std::vector<vec3> ways_off(Dice& dice, const Vec& normal) {
  std::vector<vec3> ways{unit_float(normal)};
  while (ways.size() < 24) {
    const Vec along = glm::cross(normal, dice.direction());
    const vec3 way = unit_float(along + normal * dice.power(-6, 1));
    if (glm::dot(Vec(way), normal) > 0) ways.push_back(way);
  }
  return ways;
}

/// Longest side over the height on it.
Real aspect_of(const Shot& shot) {
  const Vec a(shot.corner[0]), b(shot.corner[1]), c(shot.corner[2]);
  const Real longest = std::max({glm::length(b - a), glm::length(c - b), glm::length(a - c)});
  return longest * longest / glm::length(glm::cross(b - a, c - a));
}

// Needles too (aspects to 1e8 and past): their weights would err by the aspect times what the derivation beside
// offset_origin allows for, were it not for exact_where_ill_conditioned.
TEST(Bounds, NoRayMeetsWhereItStarts) {
  // A normal's squares are fourth powers of a triangle's sides, which here are down to 1e-4 of the size.
  Search search("offset of an origin (in units of the least that would do)", -3, 9);
  std::size_t needles = 0;
  over_decades(2500, [&](Dice& dice, int decade, Real size) {
    const Shot shot = random_shot(dice, size, false);
    const auto hit = shader::intersect(shot.origin, shot.direction, shot.corner, shot.box_pad);
    const Real aspect = aspect_of(shot);
    if (!hit.hit || !std::isfinite(aspect)) return;
    const Vec upwards =
        glm::cross(Vec(shot.corner[1]) - Vec(shot.corner[0]), Vec(shot.corner[2]) - Vec(shot.corner[0]));
    const Vec normal = glm::normalize(upwards) * (dice.range(-1, 1) < 0 ? Real(-1) : Real(1));
    const vec3 origin = shader::offset_origin(shot.corner, hit.barycentric, shot.direction, vec3(normal), 0);
    const auto ways = ways_off(dice, normal);
    auto is_free = [&](const vec3& from) {
      return std::none_of(ways.begin(), ways.end(),
                          [&](const vec3& way) { return shader::intersect(from, way, shot.corner, shot.box_pad).hit; });
    };
    const bool good = glm::dot(Vec(origin) - Vec(shot.corner[0]), normal) > 0 && is_free(origin);
    search.add(decade, good);
    if (aspect > 100) {
      needles += search.counts(decade) ? 1 : 0;
      return;
    }
    const vec3 point =
        shot.corner[0] * hit.barycentric.x + shot.corner[1] * hit.barycentric.y + shot.corner[2] * hit.barycentric.z;
    Real share = 1;
    while (share > 0x1p-8L && is_free(vec3(Vec(point) + (Vec(origin) - Vec(point)) * (share / 2)))) share /= 2;
    search.looseness(decade, 1 / share);
  });
  search.report();
  EXPECT_GT(needles, 1000U);
}

}  // namespace
}  // namespace sheaf::test
