// SPDX-License-Identifier: MIT
// Keys of rays (R 4.2): along both space-filling curves neighbours on the curve are neighbours in space, no cell is
// left out and none comes twice.
#include <algorithm>
#include <array>
#include <bit>

#include "device_fixture.hpp"
#include "interface/push/lists.h"

namespace sheaf::test {
namespace {

using Words = std::vector<std::uint32_t>;

std::uint32_t ordered(float v) {  // floats as integers of the same order
  const auto bits = std::bit_cast<std::uint32_t>(v);
  return (bits & 0x80000000U) != 0 ? ~bits : bits | 0x80000000U;
}

struct Bounds {
  glm::vec3 lo{0}, hi{1};
};

Words counters_for(std::uint32_t kind, std::size_t rays, const Bounds& bounds) {
  Words counters(gpu::COUNT_WORDS);
  counters[gpu::COUNT_RAYS + kind] = static_cast<std::uint32_t>(rays);
  for (int axis = 0; axis < 3; ++axis) {
    counters[gpu::COUNT_BOUNDS + static_cast<std::uint32_t>(axis)] = ordered(bounds.lo[axis]);
    counters[gpu::COUNT_BOUNDS + 3 + static_cast<std::uint32_t>(axis)] = ordered(bounds.hi[axis]);
  }
  return counters;
}

/// Rays and their list (in reverse slot order, so that a key put at a slot's place instead of the ray's would show).
class Batch {
 public:
  explicit Batch(const std::vector<TestRay>& rays) {
    const auto count = static_cast<std::uint32_t>(rays.size());
    gpu::Frame frame{};
    frame.capacity = count + 3;
    frame_ = buffer_of(std::vector{frame});
    rays_ = buffer_of(pack_rays(rays, frame.capacity));
    Words order(count);
    for (std::uint32_t i = 0; i < count; ++i) order[i] = count - 1 - i;
    order_ = buffer_of(order);
  }
  void bind(Recorder& recorder) const {
    recorder.bind(ROLE_FRAME, frame_);
    recorder.bind_list(LIST_RAYS, rays_);
    recorder.bind_list(LIST_ORDER, order_);
  }

 private:
  Buffer frame_, rays_, order_;
};

/// A key a ray, in the rays' order.
Words keys_of(const std::vector<TestRay>& rays, const gpu::HashPush& push, const Bounds& bounds = {},
              std::vector<gpu::Light> lights = std::vector<gpu::Light>(1)) {
  const Kernel hash(device(), "hash");
  const Batch batch(rays);
  const Buffer counters = buffer_of(counters_for(push.kind, rays.size(), bounds)), light_words = buffer_of(lights);
  const Output<std::uint32_t> keys(rays.size());
  Recorder recorder(device());
  batch.bind(recorder);
  recorder.bind(ROLE_COUNTERS, counters);
  recorder.bind(ROLE_LIGHTS, light_words);
  recorder.bind(ROLE_KEYS, keys.buffer());
  recorder.dispatch(hash, push, blocks_of(rays.size(), gpu::GROUP) + 1ULL);
  recorder.submit_and_wait();
  Words result = keys.values();
  std::reverse(result.begin(), result.end());
  return result;
}

glm::dvec3 from_octahedral(double x, double y) {  // of [0, 1]²
  glm::dvec3 d(2 * x - 1, 2 * y - 1, 0);
  d.z = 1 - std::abs(d.x) - std::abs(d.y);
  if (d.z < 0) d = {(1 - std::abs(d.y)) * (d.x < 0 ? -1 : 1), (1 - std::abs(d.x)) * (d.y < 0 ? -1 : 1), d.z};
  return glm::normalize(d);
}

/// `cells[i]` has the key `keys[i]`: a walk through all cells by their keys, one step at a time.
template <std::size_t dimensions>
void expect_curve(const Words& keys, const std::vector<std::array<int, dimensions>>& cells) {
  std::vector<int> at(cells.size(), -1);
  for (std::size_t i = 0; i < keys.size(); ++i) {
    ASSERT_LT(keys[i], cells.size());
    ASSERT_EQ(at[keys[i]], -1) << "two cells share key " << keys[i];
    at[keys[i]] = static_cast<int>(i);
  }
  for (std::size_t k = 1; k < cells.size(); ++k) {
    int steps = 0;
    for (std::size_t d = 0; d < dimensions; ++d)
      steps += std::abs(cells[static_cast<std::size_t>(at[k])][d] - cells[static_cast<std::size_t>(at[k - 1])][d]);
    ASSERT_EQ(steps, 1) << "a jump between keys " << k - 1 << " and " << k;
  }
}

TEST(DeviceHash, RaysLieAlongAHilbertCurveOfFiveDimensions) {
  for (std::uint32_t bits = 1; bits <= 3; ++bits) {
    SCOPED_TRACE(bits);
    const int side = 1 << bits;
    std::vector<std::array<int, 5>> cells;
    std::vector<TestRay> rays;
    const Bounds bounds{{-3, 5, 40}, {13, 21, 56}};
    for (int i = 0; i < side * side * side * side * side; ++i) {
      std::array<int, 5> cell{};
      for (int d = 0, rest = i; d < 5; ++d, rest /= side) cell[static_cast<std::size_t>(d)] = rest % side;
      cells.push_back(cell);
      const glm::dvec3 place = (glm::dvec3(cell[2], cell[3], cell[4]) + 0.5) / static_cast<double>(side);
      TestRay& ray = rays.emplace_back();
      ray.origin = bounds.lo + glm::vec3(place * 16.0);
      ray.direction = glm::vec3(from_octahedral((cell[0] + 0.5) / side, (cell[1] + 0.5) / side));
    }
    expect_curve(keys_of(rays, {gpu::KIND_REFLECTION, bits, 0}, bounds), cells);
    expect_curve(keys_of(rays, {gpu::KIND_REFRACTION, bits, 0}, bounds), cells);
  }
}

TEST(DeviceHash, DirectionsLieAlongAHilbertCurve) {
  gpu::Light point{};
  point.kind = gpu::LIGHT_POINT;
  for (std::uint32_t bits = 1; bits <= 8; ++bits) {
    SCOPED_TRACE(bits);
    const int side = 1 << bits;
    std::vector<std::array<int, 2>> cells;
    std::vector<TestRay> rays;
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        cells.push_back({x, y});
        rays.emplace_back().direction = glm::vec3(from_octahedral((x + 0.5) / side, (y + 0.5) / side));
      }
    expect_curve(keys_of(rays, {gpu::KIND_SHADOW, bits, 0}, {}, {point}), cells);
  }
}

TEST(DeviceHash, ShadowRaysComeLightByLight) {
  constexpr std::uint32_t lights = 11, bits = 6, light_bits = 4;
  std::vector<gpu::Light> sources(lights);
  Dice dice(5);
  for (std::uint32_t l = 0; l < lights; ++l) {
    sources[l].kind = l % 3;  // directional, point, spot
    sources[l].direction = glm::vec3(dice.direction());
  }
  std::vector<TestRay> rays(5000);
  for (auto& ray : rays) {
    ray.medium = dice.below(lights);
    ray.origin = glm::vec3(dice.cube());
    ray.direction = glm::vec3(dice.direction());
  }
  const Words keys = keys_of(rays, {gpu::KIND_SHADOW, bits, light_bits}, {{-1, -1, -1}, {1, 1, 1}}, sources);
  for (std::size_t i = 0; i < rays.size(); ++i) ASSERT_EQ(keys[i] >> (2 * bits), rays[i].medium);
}

// Rays to the sun: equal places across its direction have equal keys however far along it they lie, and rays of one
// cell are near.
TEST(DeviceHash, RaysToADirectionalLightGoByTheirPlaceAcrossIt) {
  Dice dice(8);
  for (int trial = 0; trial < 20; ++trial) {
    gpu::Light sun{};
    sun.kind = gpu::LIGHT_DIRECTIONAL;
    sun.direction = trial == 0 ? glm::vec3(0, -1, 0) : glm::vec3(dice.direction());
    const glm::dvec3 along(sun.direction);
    std::vector<TestRay> rays;
    std::vector<glm::dvec3> across;
    for (int i = 0; i < 4000; ++i) {
      const glm::dvec3 place = dice.cube();
      rays.emplace_back().origin = glm::vec3(place);
      across.push_back(place - along * glm::dot(place, along));
    }
    constexpr std::uint32_t bits = 4;
    const Words keys = keys_of(rays, {gpu::KIND_SHADOW, bits, 0}, {{-1, -1, -1}, {1, 1, 1}}, {sun});
    std::vector<std::vector<std::size_t>> cells(1U << 2 * bits);
    for (std::size_t i = 0; i < keys.size(); ++i) {
      ASSERT_LT(keys[i], cells.size());
      cells[keys[i]].push_back(i);
    }
    // The grid spans the cube's diagonal, 2·√3, in 16 cells a side; a cell's diagonal is √2 of that.
    const double widest = 2 * std::sqrt(3.0) / 16 * std::sqrt(2.0) * 1.001;
    std::size_t used = 0;
    for (const auto& cell : cells) {
      used += cell.empty() ? 0 : 1;
      for (const auto i : cell) ASSERT_LE(glm::length(across[i] - across[cell.front()]), widest);
    }
    EXPECT_GT(used, 60U);  // of 256: the cube's shadow covers a third and more of the grid
  }
}

TEST(DeviceHash, BoundsHoldEveryOriginAndNoMore) {
  const SpecConstant group{SPEC_GROUP, gpu::SCAN_GROUP};
  const Kernel kernel(device(), "hash_bounds", {&group, 1});
  for (const double scale : {1e-7, 1.0, 1e7})
    for (const auto n : boundary_sizes()) {
      if (n == 0) continue;
      Dice dice(n);
      std::vector<TestRay> rays(n);
      Bounds expected{glm::vec3(INFINITY), glm::vec3(-INFINITY)};
      for (auto& ray : rays) {
        ray.origin = glm::vec3(dice.cube() * scale);
        expected.lo = glm::min(expected.lo, ray.origin);
        expected.hi = glm::max(expected.hi, ray.origin);
      }
      const Batch batch(rays);
      Words before = counters_for(gpu::KIND_REFRACTION, n, {glm::vec3(-9e9F), glm::vec3(9e9F)});  // of the batch before
      const Buffer counters = buffer_of(before);
      Recorder recorder(device());
      batch.bind(recorder);
      recorder.bind(ROLE_COUNTERS, counters);
      gpu::BoundsPush push{gpu::KIND_REFRACTION, 1};
      recorder.dispatch(kernel, push, 1);
      push.reset = 0;
      recorder.dispatch(kernel, push, blocks_of(n));
      recorder.submit_and_wait();
      const Words after = read<std::uint32_t>(recorder, counters, gpu::COUNT_WORDS);
      ASSERT_EQ(after, counters_for(gpu::KIND_REFRACTION, n, expected)) << n << " at " << scale;
    }
}

}  // namespace
}  // namespace sheaf::test
