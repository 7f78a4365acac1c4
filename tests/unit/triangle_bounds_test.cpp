// SPDX-License-Identifier: MIT
// Spheres and boxes of triangles, and the offset that keeps a ray off the one it starts on.
#include "bounds_search.hpp"

namespace sheaf::test {
namespace {

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
