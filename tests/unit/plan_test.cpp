// SPDX-License-Identifier: MIT
// What the plan makes of a scene's features alone.
#include <gtest/gtest.h>

#include <algorithm>

#include "device_data/features.hpp"

namespace sheaf {
namespace {

bool leaves_out(const Plan& plan, const char* stage) {
  return std::any_of(plan.left_out.begin(), plan.left_out.end(), [&](const auto& left) { return left.stage == stage; });
}

bool poses(std::uint64_t triangles, std::uint64_t distinct, InstancePolicy policy = InstancePolicy::automatic) {
  Features features;
  features.triangles = triangles;
  features.distinct_triangles = distinct;
  RenderSettings settings;
  settings.instances = policy;
  const Plan plan = make_plan(features, settings, Strategy::bvh);
  EXPECT_EQ(plan.transform_on_fetch, leaves_out(plan, "triangles in world space"));
  return plan.transform_on_fetch;
}

TEST(Plan, SharesInstancesWhereThatSavesMuch) {
  constexpr std::uint64_t million = 1000 * 1000;
  EXPECT_TRUE(poses(10 * million, million));
  EXPECT_FALSE(poses(10 * million, 10 * million)) << "nothing is there twice";
  EXPECT_FALSE(poses(30 * million, 20 * million)) << "most are there once";
  EXPECT_FALSE(poses(8 * million, 1)) << "too few to be worth the time";
}

TEST(Plan, SharesInstancesWhereToldTo) {
  EXPECT_TRUE(poses(100, 100, InstancePolicy::shared));
  EXPECT_FALSE(poses(100'000'000, 1, InstancePolicy::copied));
}

}  // namespace
}  // namespace sheaf
