// SPDX-License-Identifier: MIT
#include "scene/pose.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "core/error.hpp"

namespace sheaf {
namespace {

using std::numbers::pi;

// Nodes in a chain, the first a root.
Scene chain(std::size_t count) {
  Scene scene;
  scene.nodes.resize(count);
  scene.roots = {0};
  for (std::uint32_t i = 0; i < count; ++i) {
    scene.order.push_back(i);
    if (i > 0) {
      scene.nodes[i].parent = i - 1;
      scene.nodes[i - 1].children = {i};
    }
  }
  return scene;
}

Channel channel(ChannelPath path, Interpolation mode, std::vector<double> times, std::vector<double> values) {
  const std::uint32_t width = path == ChannelPath::rotation ? 4 : path == ChannelPath::weights ? 2 : 3;
  return {0, path, mode, width, std::move(times), std::move(values)};
}

Scene animated(Channel c) {
  Scene scene = chain(1);
  scene.animations.push_back({"move", {std::move(c)}, 0});
  return scene;
}

glm::dvec3 translation_at(const Scene& scene, double time) {
  return glm::dvec3(evaluate_pose(scene, {0}, time).world[0][3]);
}
glm::dvec3 x_axis_at(const Scene& scene, double time) {
  return glm::dvec3(evaluate_pose(scene, {0}, time).world[0][0]);
}

void expect_near(const glm::dvec3& a, const glm::dvec3& b, double tolerance = 1e-12) {
  EXPECT_LT(glm::distance(a, b), tolerance)
      << a.x << " " << a.y << " " << a.z << " is not " << b.x << " " << b.y << " " << b.z;
}

TEST(Pose, ParentsMultiplyFromTheLeft) {
  // The child's point (1,0,0): scaled to (2,0,0), turned by 90° about z to (0,2,0), moved by (0,0,5), then the parent's
  // matrix moves it by (10,0,0) and mirrors y.
  Scene scene = chain(2);
  scene.nodes[0].has_matrix = true;
  scene.nodes[0].matrix = glm::scale(glm::translate(glm::dmat4(1), {10, 0, 0}), {1, -1, 1});
  scene.nodes[1].translation = {0, 0, 5};
  scene.nodes[1].rotation = {std::sqrt(0.5), 0, 0, std::sqrt(0.5)};
  scene.nodes[1].scale = {2, 3, 4};
  const Pose pose = evaluate_pose(scene, {}, 0);
  expect_near(glm::dvec3(pose.world[1] * glm::dvec4(1, 0, 0, 1)), {10, -2, 5});
}

TEST(Pose, NodesOutsideTheSceneStayIdentity) {
  Scene scene = chain(1);
  scene.nodes.emplace_back();
  scene.nodes[1].translation = {1, 2, 3};
  EXPECT_EQ(evaluate_pose(scene, {}, 0).world[1], glm::dmat4(1));
}

TEST(Pose, LinearAndStepAndClamping) {
  const std::vector<double> times = {1, 3}, values = {0, 0, 0, 4, 8, 0};
  const Scene linear = animated(channel(ChannelPath::translation, Interpolation::linear, times, values));
  expect_near(translation_at(linear, 1.5), {1, 2, 0});
  expect_near(translation_at(linear, -5), {0, 0, 0});
  expect_near(translation_at(linear, 99), {4, 8, 0});
  const Scene step = animated(channel(ChannelPath::translation, Interpolation::step, times, values));
  expect_near(translation_at(step, 2.999), {0, 0, 0});
  expect_near(translation_at(step, 3), {4, 8, 0});
}

TEST(Pose, SingleKeysHold) {
  expect_near(translation_at(animated(channel(ChannelPath::translation, Interpolation::linear, {2}, {1, 2, 3})), 0),
              {1, 2, 3});
  const Channel cubic =
      channel(ChannelPath::translation, Interpolation::cubic_spline, {2}, {9, 9, 9, 1, 2, 3, 9, 9, 9});
  for (const double time : {0.0, 2.0, 5.0}) expect_near(translation_at(animated(cubic), time), {1, 2, 3});
}

TEST(Pose, CubicSplineMatchesTheHermiteForm) {
  // From 0 with slope 1 to 10 with slope 2 in 4 s; at the middle: h00 = h01 = 1/2, h10 = 1/8, h11 = -1/8, the slopes
  // times the span: 5 + 4/8 - 8/8 = 4.5.
  const Channel c = channel(ChannelPath::translation, Interpolation::cubic_spline, {0, 4},
                            {7, 0, 0, 0, 0, 0, 1, 0, 0, 2, 0, 0, 10, 0, 0, 7, 0, 0});
  expect_near(translation_at(animated(c), 2), {4.5, 0, 0});
  expect_near(translation_at(animated(c), 4), {10, 0, 0});
}

TEST(Pose, KeysATenthOfAMicrosecondApart) {
  const double t = 1, dt = 1e-7;
  const Scene scene = animated(channel(ChannelPath::translation, Interpolation::linear, {0, t, t + dt, 2},
                                       {0, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0}));
  expect_near(translation_at(scene, t + dt / 2), {0.5, 0, 0}, 1e-6);
  expect_near(translation_at(scene, t + 2 * dt), {1, 0, 0});
}

TEST(Pose, RotationsTakeTheShorterWayAtConstantSpeed) {
  const double h = std::sqrt(0.5);
  for (const double sign : {1.0, -1.0}) {  // -q is the same rotation
    const Scene scene =
        animated(channel(ChannelPath::rotation, Interpolation::linear, {0, 1}, {0, 0, 0, 1, 0, 0, sign * h, sign * h}));
    expect_near(x_axis_at(scene, 1.0 / 3), {std::cos(pi / 6), std::sin(pi / 6), 0});
    expect_near(x_axis_at(scene, 1), {0, 1, 0});
  }
}

TEST(Pose, RotationsOfHalfATurnAndOfNoLength) {
  // Half a turn has two shorter ways: any is right as long as it stays a rotation.
  const Scene half = animated(channel(ChannelPath::rotation, Interpolation::linear, {0, 1}, {0, 0, 0, 1, 0, 0, 1, 0}));
  EXPECT_NEAR(std::abs(x_axis_at(half, 0.5).y), 1, 1e-12);
  const Scene opposite =
      animated(channel(ChannelPath::rotation, Interpolation::linear, {0, 1}, {0, 0, 0, 1, 0, 0, 0, -1}));
  expect_near(x_axis_at(opposite, 0.5), {1, 0, 0});
  const Scene zero = animated(channel(ChannelPath::rotation, Interpolation::step, {0}, {0, 0, 0, 0}));
  expect_near(x_axis_at(zero, 0), {1, 0, 0});
  // A spline may pass through zero between its keys.
  const Scene spline = animated(channel(ChannelPath::rotation, Interpolation::cubic_spline, {0, 1},
                                        {0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, -1, 0, 0, 0, 0}));
  expect_near(x_axis_at(spline, 0.5), {1, 0, 0});
}

TEST(Pose, AnimatedMatricesAreTakenApart) {
  Scene scene = animated(channel(ChannelPath::translation, Interpolation::step, {0}, {7, 7, 7}));
  scene.nodes[0].has_matrix = true;
  const glm::dmat4 turn = glm::rotate(glm::dmat4(1), 0.7, glm::normalize(glm::dvec3(1, 2, 3)));
  scene.nodes[0].matrix = glm::translate(glm::dmat4(1), {1, 2, 3}) * turn * glm::scale(glm::dmat4(1), {2, -3, 4});
  glm::dmat4 expected = scene.nodes[0].matrix;
  expected[3] = glm::dvec4(7, 7, 7, 1);
  const glm::dmat4 world = evaluate_pose(scene, {0}, 0).world[0];
  for (int c = 0; c < 4; ++c) expect_near(glm::dvec3(world[c]), glm::dvec3(expected[c]));
}

TEST(Pose, MorphWeights) {
  Scene scene = animated(channel(ChannelPath::weights, Interpolation::linear, {0, 1}, {0, 1, 1, 0}));
  scene.nodes[0].morph_weights = {0.25, 0.5};
  EXPECT_EQ(evaluate_pose(scene, {}, 0).morph_weights[0], (std::vector<double>{0.25, 0.5}));
  EXPECT_EQ(evaluate_pose(scene, {0}, 0.25).morph_weights[0], (std::vector<double>{0.25, 0.75}));
  EXPECT_TRUE(morphing_nodes(scene, {0})[0]);
  EXPECT_FALSE(moving_nodes(scene, {0})[0]);
}

TEST(Pose, LaterAnimationsOverrideAndChildrenMoveAlong) {
  Scene scene = chain(3);
  Channel first = channel(ChannelPath::translation, Interpolation::step, {0}, {1, 0, 0}), second = first;
  first.node = second.node = 1;
  second.values = {2, 0, 0};
  scene.animations = {{"walk", {first}, 0}, {"run", {second}, 0}};
  EXPECT_EQ(evaluate_pose(scene, select_animations(scene, "all"), 0).world[2][3].x, 2.0);
  EXPECT_EQ(moving_nodes(scene, {0}), (std::vector<bool>{false, true, true}));
}

TEST(Pose, AnimationsAreSelectedByNameIndexAndAll) {
  Scene scene = chain(1);
  EXPECT_TRUE(select_animations(scene, "").empty());
  EXPECT_TRUE(select_animations(scene, "all").empty());
  scene.animations = {{"walk", {}, 0}, {"run", {}, 0}};
  EXPECT_EQ(select_animations(scene, ""), std::vector<std::uint32_t>{0});
  EXPECT_EQ(select_animations(scene, "run"), std::vector<std::uint32_t>{1});
  EXPECT_EQ(select_animations(scene, "1"), std::vector<std::uint32_t>{1});
  EXPECT_EQ(select_animations(scene, "all"), (std::vector<std::uint32_t>{0, 1}));
  for (const char* wrong : {"2", "-1", "fly", "99999999999999999999"})
    EXPECT_THROW((void)select_animations(scene, wrong), Error) << wrong;
}

}  // namespace
}  // namespace sheaf
