// SPDX-License-Identifier: MIT
// The reference renderer where rays go on: mirrors by Schlick, glass by Snell, Fresnel, Beer and Lambert.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "reference_scenes.hpp"

namespace sheaf {
namespace {

using namespace test;
constexpr double pi = std::numbers::pi;

Material mirror(const glm::vec3& color) {
  Material m;
  m.base_color = glm::vec4(color, 1);
  m.roughness = 0;
  return m;
}

double fresnel_by_angles(double i, double n1, double n2) {  // Fresnel's sine and tangent forms, unlike the engine's
  if (i == 0) return std::pow((n1 - n2) / (n1 + n2), 2);
  const double t = std::asin(n1 / n2 * std::sin(i));
  return 0.5 * (std::pow(std::sin(i - t) / std::sin(i + t), 2) + std::pow(std::tan(i - t) / std::tan(i + t), 2));
}

TEST(ReferenceGlass, MirrorShowsWhatIsBesideIt) {
  SceneBuilder b;
  const float c = std::sqrt(0.5f);
  b.darkness();
  b.mesh(SceneBuilder::quad({0, 0, 0}, {c, 0, c}, {0, 1, 0}, 1), b.material(mirror(glm::vec3(0.5f))));
  b.mesh(SceneBuilder::quad({-5, 0, 0}, {0, 1, 0}, {0, 0, 1}, 2), b.unlit({0.2f, 0.4f, 0.6f}));
  const double f = 0.5 + 0.5 * std::pow(1 - std::sqrt(0.5), 5);
  expect_color(look(b, beam({0, 0, 4}, {0, 0, -1})), f * glm::dvec3(0.2, 0.4, 0.6));
  ReferenceSettings no_rays;
  no_rays.depth = 0;
  expect_color(look(b, beam({0, 0, 4}, {0, 0, -1}), no_rays), glm::dvec3(0), 0);
}

TEST(ReferenceGlass, FacingMirrorsLoseWhatEachReflectionTakes) {
  SceneBuilder b;
  b.darkness();
  const std::uint32_t m = b.material(mirror(glm::vec3(0.9f)));
  b.mesh(SceneBuilder::floor(0, 1), m);
  b.mesh(SceneBuilder::quad({0, 0, 1}, {1, 0, 0}, {0, -1, 0}, 1), m);
  // Emission 1 at every hit: the sum of 0.9^k over the 65 hits of depth 64.
  b.scene.materials[m].emissive = glm::vec3(1);
  ReferenceSettings deep;
  deep.depth = 64;
  deep.cutoff = 0;
  const double share = static_cast<double>(0.9f);
  expect_color(look(b, beam({0, 0, 0.5}, {0, 0, -1}), deep), glm::dvec3((1 - std::pow(share, 65)) / (1 - share)), 1e-5);
}

class GlassSlab : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Degrees, GlassSlab, testing::Values(0.0, 10.0, 45.0, 80.0));

TEST_P(GlassSlab, BendsBySnellAndSplitsByFresnel) {
  SceneBuilder b;
  b.darkness();
  b.mesh(SceneBuilder::box({-40, -40, -1}, {40, 40, 0}), b.material(glass(1.5f)));
  add_ramp(b, -2);
  const double i = GetParam() * pi / 180, t = std::asin(std::sin(i) / 1.5);
  const double f = fresnel_by_angles(i, 1, 1.5), start = -1 - std::tan(t) - std::tan(i);  // lands near x = -1 + ...
  const auto seen_at = [](double x) { return glm::dvec3(0.5 + x / 10, 0.5, 1); };
  const CameraView view = beam({start - std::tan(i), 0, 1}, {std::sin(i), 0, -std::cos(i)});
  // Enters at x = start, leaves the lower face tan t further on, meets the backdrop another tan i on.
  const glm::dvec3 direct = std::pow(1 - f, 2) * seen_at(-1);
  ReferenceSettings settings;
  settings.cutoff = 0;
  settings.depth = 2;
  expect_color(look(b, view, settings), direct);
  // Two more generations let the first inner round trip out: 2 tan t further on, weaker by f².
  settings.depth = 4;
  expect_color(look(b, view, settings), direct + std::pow(f * (1 - f), 2) * seen_at(-1 + 2 * std::tan(t)));
}

TEST(ReferenceGlass, TotalReflectionAtTheCriticalAngle) {
  SceneBuilder b;
  b.darkness();
  b.mesh(SceneBuilder::box({-40, -40, -10}, {40, 40, 0}), b.material(glass(1.5f)));
  b.mesh(SceneBuilder::floor(5, 1e6f), b.unlit({0, 1, 0}));  // seen through the upper face
  b.mesh(SceneBuilder::floor(-1, 40), b.unlit({1, 0, 0}));   // inside the glass, seen by reflection
  const double critical = std::asin(1 / 1.5);
  const auto at = [&](double angle) {
    ReferenceSettings settings;
    settings.cutoff = 0;
    settings.depth = 1;
    settings.show_backs = true;
    return look(b, beam({0, 0, -0.5}, {std::sin(angle), 0, std::cos(angle)}), settings);
  };
  expect_color(at(critical + 1e-7), {1, 0, 0}, 0);
  expect_color(at(1.2), {1, 0, 0}, 0);
  for (const double below : {1e-7, 1e-3, 0.1, 0.7}) {
    const double f = fresnel_by_angles(critical - below, 1.5, 1);
    expect_color(at(critical - below), {f, 1 - f, 0}, 2e-6);
  }
}

TEST(ReferenceGlass, AbsorptionFollowsBeerAndLambert) {
  SceneBuilder b;
  b.darkness();
  Material m = glass(1.5f);
  m.attenuation_color = {0.5f, 0.25f, 0.125f};
  m.attenuation_distance = 2;
  b.mesh(SceneBuilder::box({-4, -4, -3}, {4, 4, 0}), b.material(m));
  b.mesh(SceneBuilder::floor(-4, 5), b.unlit(glm::vec3(1)));
  ReferenceSettings settings;
  settings.depth = 2;
  const glm::dvec3 through = 0.96 * 0.96 * glm::pow(glm::dvec3(0.5, 0.25, 0.125), glm::dvec3(1.5));
  expect_color(look(b, beam({0.3, 0.2, 1}, {0, 0, -1}), settings), through);
  // From inside, the rest of the way only.
  const glm::dvec3 rest = 0.96 * glm::pow(glm::dvec3(0.5, 0.25, 0.125), glm::dvec3(0.5));
  expect_color(look(b, beam({0.3, 0.2, -2}, {0, 0, -1}), settings), rest);
}

TEST(ReferenceGlass, NestedVolumesUseTheInnerOne) {
  SceneBuilder b;
  b.darkness();
  b.mesh(SceneBuilder::box({-4, -4, -3}, {4, 4, 0}), b.material(glass(1.5f)));
  Material inner = glass(1.5f);  // the same index: no reflection between the two
  inner.attenuation_color = glm::vec3(0.5f);
  inner.attenuation_distance = 1;
  b.mesh(SceneBuilder::box({-2, -2, -2}, {2, 2, -1}), b.material(inner));
  b.mesh(SceneBuilder::floor(-4, 5), b.unlit(glm::vec3(1)));
  expect_color(look(b, beam({0.3, 0.2, 1}, {0, 0, -1})), glm::dvec3(0.96 * 0.96 * 0.5));
}

TEST(ReferenceGlass, ShadowIsTintedByWhatLightPassesThrough) {
  Material lambert;
  lambert.metallic = 0;
  lambert.ior = 1;
  Material m = glass(1.5f);
  m.base_color = {0.9f, 0.8f, 0.7f, 1};
  m.attenuation_color = {0.5f, 0.25f, 0.125f};
  m.attenuation_distance = 2;
  const glm::dvec3 tint = glm::pow(0.96 * glm::dvec3(0.9f, 0.8f, 0.7f), glm::dvec3(2)) * glm::dvec3(0.5, 0.25, 0.125);
  for (const LightKind kind : {LightKind::point, LightKind::directional}) {
    SceneBuilder b;
    b.mesh(SceneBuilder::floor(0, 50), b.material(lambert));
    b.mesh(SceneBuilder::box({-4, -4, 1}, {4, 4, 3}), b.material(m));
    Light l;
    l.kind = kind;
    l.intensity = static_cast<float>(pi) * (kind == LightKind::point ? 16 : 1);
    b.light(l, glm::translate(glm::dmat4(1), {0.3, 0.2, 4}));
    expect_color(look(b, beam({0.3, 0.2, 0.5}, {0, 0, -1})), tint);
  }
}

TEST(ReferenceGlass, LightInsideAVolumeIsAbsorbedToItsSurface) {
  SceneBuilder b;
  Material lambert;
  lambert.metallic = 0;
  lambert.ior = 1;
  b.mesh(SceneBuilder::floor(0, 50), b.material(lambert));
  Material m = glass(1.5f);
  m.attenuation_color = glm::vec3(0.5f);
  m.attenuation_distance = 1;
  b.mesh(SceneBuilder::box({-4, -4, 1}, {4, 4, 3}), b.material(m));
  b.point_light({0.3, 0.2, 2}, static_cast<float>(4 * pi));
  // The sum of crossings is 1 m too little and is held at 0: only the surface counts (SHADING.md, Shadow rays).
  expect_color(look(b, beam({0.3, 0.2, 0.5}, {0, 0, -1})), glm::dvec3(0.96));
}

}  // namespace
}  // namespace sheaf
