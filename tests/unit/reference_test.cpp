// SPDX-License-Identifier: MIT
// The reference renderer on scenes whose pictures follow from a formula: light, shadow, cover, layers, geometry.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/error.hpp"
#include "reference_scenes.hpp"

namespace sheaf {
namespace {

using namespace test;
constexpr double pi = std::numbers::pi;

TEST(Reference, LitPlaneFollowsTheFormula) {
  SceneBuilder b;
  Material m;
  m.base_color = {0.8f, 0.4f, 0.2f, 1};
  m.metallic = 0;
  m.roughness = 1;
  b.mesh(SceneBuilder::floor(0, 50), b.material(m));
  b.point_light({0, 0, 2}, 10);
  // Straight above: F = 0.04, D = 1/π, V = 1/4, L = 10/4.
  glm::dvec3 base(0.8, 0.4, 0.2);
  expect_color(look(b, beam({0, 0, 5}, {0, 0, -1})), (0.96 * base + 0.01) / pi * 2.5);
  // At x = 2: 45° of incidence, looked at from above.
  const double c = std::sqrt(0.5), f = 0.04 + 0.96 * std::pow(1 - std::cos(pi / 8), 5);
  const double v = 0.5 / (c + 1);
  expect_color(look(b, beam({2, 0, 5}, {0, 0, -1})), ((1 - f) * base + f * v) / pi * (10.0 / 8) * c);
}

TEST(Reference, HighlightFollowsGgx) {
  SceneBuilder b;
  Material m;  // a metal: its base colour is the mirror's, nothing is diffuse
  m.base_color = {0.5f, 0.5f, 0.5f, 1};
  m.roughness = 0.5f;
  b.mesh(SceneBuilder::floor(0, 50), b.material(m));
  b.point_light({0, 0, 2}, 10);
  const double nl = std::sqrt(0.5), nh = std::cos(pi / 8), a2 = 0.0625;
  const double f = 0.5 + 0.5 * std::pow(1 - nh, 5), d = a2 / (pi * std::pow(nh * nh * (a2 - 1) + 1, 2));
  const double v = 0.5 / (nl + std::sqrt(nl * nl * (1 - a2) + a2));
  expect_color(look(b, beam({2, 0, 5}, {0, 0, -1})), glm::dvec3(f * d * v * 10 / 8 * nl));
}

TEST(Reference, SpotAndRangeFade) {
  SceneBuilder b;
  Material m;
  m.metallic = 0;
  m.ior = 1;  // no Fresnel share at normal incidence: plain Lambert
  b.mesh(SceneBuilder::floor(0, 50), b.material(m));
  Light l;
  l.kind = LightKind::spot;
  l.intensity = 4;
  l.range = 4;
  l.inner_cone = 0;
  l.outer_cone = static_cast<float>(pi / 3);
  b.light(l, glm::translate(glm::dmat4(1), {0, 0, 2}));
  expect_color(look(b, beam({0, 0, 5}, {0, 0, -1})), glm::dvec3(1 / pi * (1 - 1.0 / 16)));
  // Outside the cone: 60° and more.
  expect_color(look(b, beam({3.6, 0, 5}, {0, 0, -1})), glm::dvec3(0), 0);
}

TEST(Reference, ShadowIsBlack) {
  SceneBuilder b;
  Material m;
  b.mesh(SceneBuilder::floor(0, 50), b.material(m));
  b.mesh(SceneBuilder::floor(1, 0.5f), b.material(m));
  b.point_light({0, 0, 2}, 10);
  expect_color(look(b, beam({0.9, 0, 0.5}, {0, 0, -1})), glm::dvec3(0), 0);
  EXPECT_GT(look(b, beam({1.1, 0, 0.5}, {0, 0, -1})).r, 0.001f);
}

TEST(Reference, BlendCoversByItsAlpha) {
  SceneBuilder b;
  b.darkness();
  Material m;
  m.base_color = {1, 0.5f, 0, 0.25f};
  m.alpha_mode = AlphaMode::blend;
  m.unlit = true;
  b.mesh(SceneBuilder::floor(1, 1), b.material(m));
  EXPECT_EQ(look(b, beam({0.3, 0.2, 2}, {0, 0, -1})), glm::vec4(0.25f, 0.125f, 0, 0.25f));
  b.mesh(SceneBuilder::floor(0, 1), b.unlit({0, 0, 1}));
  EXPECT_EQ(look(b, beam({0.3, 0.2, 2}, {0, 0, -1})), glm::vec4(0.25f, 0.125f, 0.75f, 1));
  ReferenceSettings opaque;
  opaque.opaque = true;
  EXPECT_EQ(look(b, beam({0.3, 0.2, 2}, {0, 0, -1}), opaque), glm::vec4(1, 0.5f, 0, 1));
}

TEST(Reference, MaskCutsByTexture) {
  SceneBuilder b;
  b.darkness();
  Image image;
  image.width = 2;
  image.height = 1;
  image.rgba = {255, 255, 255, 127, 255, 255, 255, 128};
  b.scene.images.push_back(image);
  Texture texture;
  texture.image = 0;
  texture.nearest = true;
  b.scene.textures.push_back(texture);
  Material m;
  m.base_color = {1, 0, 0, 1};
  m.alpha_mode = AlphaMode::mask;
  m.unlit = true;
  m.base_color_texture.texture = 0;
  b.mesh(SceneBuilder::floor(1, 1), b.material(m));
  EXPECT_EQ(look(b, beam({-0.5, 0.2, 2}, {0, 0, -1})), glm::vec4(0));
  EXPECT_EQ(look(b, beam({0.5, 0.2, 2}, {0, 0, -1})), glm::vec4(1, 0, 0, 1));
}

TEST(Reference, DefaultLightAndEnvironment) {
  SceneBuilder b;
  Material m;
  m.metallic = 0;
  m.ior = 1;  // Schlick is 0 where looked at straight on
  b.mesh(SceneBuilder::floor(0, 50), b.material(m));
  const double cosine = 1 / std::sqrt(0.4 * 0.4 + 0.7 * 0.7 + 1);
  const double f = std::pow(1 - std::sqrt((1 + cosine) / 2), 5), v = 0.5 / (cosine + 1);
  expect_color(look(b, beam({0, 0, 5}, {0, 0, -1})), glm::dvec3(3 * cosine / pi * (1 - f + f * v) + 0.4));
  ReferenceSettings settings;
  settings.environment = glm::dvec3(0.1, 0.2, 0.3);
  b.darkness();
  expect_color(look(b, beam({0, 0, 5}, {0, 0, -1}), settings), {0.1, 0.2, 0.3});
}

TEST(Reference, LayersSayWhatTheFirstRayHit) {
  SceneBuilder b;
  b.darkness();
  add_ramp(b, 0);
  CameraView view;  // at the origin of its space, looking down -z
  view.to_world = glm::translate(glm::dmat4(1), {0, 0, 4});
  view.tan_half_y = 0.5;
  ReferenceSettings settings;
  settings.width = 4;
  settings.height = 2;
  const ReferenceFrame frame = render_reference(b.scene, b.pose, view, settings);
  // Pixel (3, 0): sx = 0.75, sy = 0.5, so at depth 4 it sees x = 0.75 * 0.5 * 2 * 4 = 3, y = 1.
  EXPECT_FLOAT_EQ(frame.depth[3], 4);
  EXPECT_NEAR(frame.position[3].x, 3, 1e-12);
  EXPECT_NEAR(frame.position[3].y, 1, 1e-12);
  EXPECT_NEAR(frame.albedo[3].r, 0.8, 1e-7);
  EXPECT_NEAR(frame.uv[3].x, 0.8, 1e-6);
  EXPECT_NEAR(frame.uv[3].y, 0.4, 1e-6);
  EXPECT_EQ(frame.normal[3], glm::vec3(0, 0, 1));
  EXPECT_EQ(frame.object[3], 2u);
  EXPECT_EQ(frame.material[3], 2u);
  EXPECT_EQ(frame.triangle[3], 0u);
  EXPECT_EQ(frame.counts.rays[0], 8u);
  view.near = 5;
  const ReferenceFrame cut = render_reference(b.scene, b.pose, view, settings);
  EXPECT_EQ(cut.triangle[3], none);
  EXPECT_EQ(cut.depth[3], std::numeric_limits<float>::infinity());
  EXPECT_EQ(cut.rgba[3], glm::vec4(0));
}

TEST(Reference, FarFromTheOriginNothingIsLost) {
  const auto picture = [](const glm::dvec3& shift) {
    SceneBuilder b;
    Material m;
    m.roughness = 0.2f;
    Mesh box = SceneBuilder::box({-1, -1, -1}, {1, 1, 1});
    box.centre = shift;
    b.mesh(box, b.material(m));
    b.point_light(shift + glm::dvec3(3, 2, 4), 50);
    CameraView view;
    view.to_world = glm::translate(glm::dmat4(1), shift + glm::dvec3(0.5, 0.25, 5));
    ReferenceSettings settings;
    settings.width = settings.height = 16;
    return render_reference(b.scene, b.pose, view, settings).rgba;
  };
  const auto near = picture(glm::dvec3(0)), far = picture(glm::dvec3(1e7, -1e7, 1e7));
  float brightest = 0;
  for (std::size_t i = 0; i < near.size(); ++i) {
    brightest = std::max(brightest, near[i].r);
    expect_color(far[i], glm::dvec3(near[i]), 1e-6);
  }
  EXPECT_GT(brightest, 0.05f);
}

TEST(Reference, MorphThenSkin) {
  SceneBuilder b;
  Mesh m = SceneBuilder::floor(0, 1);
  m.targets.resize(1);
  m.targets[0].positions.assign(4, glm::vec3(0, 0, 2));
  m.joints.assign(4, {0, 1, 0, 0, 0, 0, 0, 0});
  m.weights.assign(4, {0.25f, 0.75f, 0, 0, 0, 0, 0, 0});
  const std::uint32_t skinned = b.mesh(m, 0, glm::translate(glm::dmat4(1), {100, 0, 0}));  // its own matrix is ignored
  const std::uint32_t first = b.node(glm::translate(glm::dmat4(1), {0, 4, 0}));
  const std::uint32_t second = b.node(glm::scale(glm::dmat4(1), {1, 1, 3}));
  Skin skin;
  skin.joints = {first, second};
  skin.inverse_bind = {glm::translate(glm::dmat4(1), {0, 0, 8}), glm::dmat4(1)};
  b.scene.skins.push_back(skin);
  b.scene.nodes[skinned].skin = 0;
  b.pose.morph_weights[skinned] = {0.5};
  // z = 0.5 * 2 = 1 after morphing; joint 0 gives (x, y + 4, 9), joint 1 (x, y, 3).
  const auto triangles = reference_triangles(b.scene, b.pose, glm::dvec3(10, 0, 0));
  ASSERT_EQ(triangles.size(), 2u);
  const glm::dvec3 expected(-11, 0, 0.25 * 9 + 0.75 * 3);
  EXPECT_NEAR(glm::distance(triangles[0].v[0], expected), 0, 1e-12);
}

TEST(Reference, NegativeScaleKeepsTheFront) {
  SceneBuilder b;
  Material m;
  m.metallic = 0;
  b.mesh(SceneBuilder::floor(0, 1), b.material(m), glm::scale(glm::dmat4(1), {-2, 1, 1}));
  b.darkness();
  ReferenceSettings settings;
  settings.width = settings.height = 1;
  const auto frame = render_reference(b.scene, b.pose, beam({0.3, 0.2, 2}, {0, 0, -1}), settings);
  EXPECT_EQ(frame.normal[0], glm::vec3(0, 0, 1));
  // A volume seen from outside is entered, which only holds if its fronts are known.
  SceneBuilder v;
  v.darkness();
  Material tinted = glass(1.5f);
  tinted.attenuation_color = glm::vec3(0.5f);
  tinted.attenuation_distance = 1;
  v.mesh(SceneBuilder::box({-4, -4, -1}, {4, 4, 0}), v.material(tinted), glm::scale(glm::dmat4(1), {-1, 1, 1}));
  v.mesh(SceneBuilder::floor(-4, 5), v.unlit(glm::vec3(1)));
  settings.depth = 2;
  expect_color(look(v, beam({0.3, 0.2, 1}, {0, 0, -1}), settings), glm::dvec3(0.96 * 0.96 * 0.5));
}

TEST(Reference, NormalMapTiltsTheNormal) {
  SceneBuilder b;
  b.darkness();
  Image image;
  image.width = image.height = 1;
  image.rgba = {255, 128, 128, 255};
  b.scene.images.push_back(image);
  b.scene.textures.emplace_back().image = 0;
  Material m;
  m.normal_texture.texture = 0;
  m.normal_texture.strength = 0.5f;
  Mesh mesh = SceneBuilder::floor(0, 1);
  mesh.tangents.assign(4, glm::vec4(1, 0, 0, 1));
  b.mesh(mesh, b.material(m));
  ReferenceSettings settings;
  settings.width = settings.height = 1;
  const auto frame = render_reference(b.scene, b.pose, beam({0.3, 0.2, 2}, {0, 0, -1}), settings);
  const double e = 1.0 / 255;  // 128 decodes to 1/255
  const glm::dvec3 n = glm::normalize(glm::dvec3(0.5, 0.5 * e, e));
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(frame.normal[0][c], n[c], 1e-6);
}

TEST(Reference, ThreadsDoNotChangeThePicture) {
  SceneBuilder b;
  b.mesh(SceneBuilder::box({-1, -1, -1}, {1, 1, 1}), b.material(glass(1.3f)));
  add_ramp(b, -2);
  CameraView view;
  view.to_world = glm::translate(glm::dmat4(1), {0.1, 0.2, 5});
  ReferenceSettings settings;
  settings.width = settings.height = 24;
  settings.spp = 3;
  settings.threads = 1;
  const auto one = render_reference(b.scene, b.pose, view, settings);
  settings.threads = 4;
  const auto four = render_reference(b.scene, b.pose, view, settings);
  EXPECT_EQ(one.rgba, four.rgba);
  EXPECT_EQ(one.counts.rays, four.counts.rays);
  EXPECT_EQ(one.counts.triangle_tests, four.counts.triangle_tests);
}

TEST(Reference, RefusesAndStops) {
  SceneBuilder b;
  b.mesh(SceneBuilder::floor(0, 1), 0);
  ReferenceSettings settings;
  settings.width = 0;
  EXPECT_THROW((void)render_reference(b.scene, b.pose, beam({0, 0, 1}, {0, 0, -1}), settings), Error);
  settings = {};
  settings.spp = 0;
  EXPECT_THROW((void)render_reference(b.scene, b.pose, beam({0, 0, 1}, {0, 0, -1}), settings), Error);
  settings = {};
  settings.stop = [] { return true; };
  try {
    (void)render_reference(b.scene, b.pose, beam({0, 0, 1}, {0, 0, -1}), settings);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::interrupted);
  }
  EXPECT_EQ(look(SceneBuilder(), beam({0, 0, 1}, {0, 0, -1})), glm::vec4(0));
}

}  // namespace
}  // namespace sheaf
