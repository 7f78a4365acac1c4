// SPDX-License-Identifier: MIT
// What tests of device kernels share: one device a process, buffers made of vectors, results read back. A process ends
// with the check that the validation layer, where it is on, had nothing to say.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "vulkan/recorder.hpp"

namespace sheaf::test {

class DeviceEnvironment final : public ::testing::Environment {
 public:
  /// Lavapipe, whose arithmetic these tests know; SHEAF_TEST_DEVICE names another.
  static const Device& device() {
    const char* name = std::getenv("SHEAF_TEST_DEVICE");
    if (!owner()) owner() = std::make_unique<Device>(name != nullptr ? name : "llvmpipe");
    return *owner();
  }
  void TearDown() override {
    owner().reset();  // the layer reports what was left behind
    EXPECT_EQ(Device::validation_messages(), 0U);
  }

 private:
  static std::unique_ptr<Device>& owner() {
    static std::unique_ptr<Device> owned;
    return owned;
  }
};

inline const auto* const device_environment = ::testing::AddGlobalTestEnvironment(new DeviceEnvironment);
inline const Device& device() { return DeviceEnvironment::device(); }

/// Host and kernels share it, bound or by its address.
template <typename T>
Buffer buffer_of(const std::vector<T>& values) {
  Buffer buffer(device(), "test input", values.size() * sizeof(T), Buffer::Kind::upload,
                vk::BufferUsageFlagBits::eShaderDeviceAddress);
  if (!values.empty()) std::memcpy(buffer.mapped(), values.data(), values.size() * sizeof(T));
  return buffer;
}

/// Runs what was recorded, then fetches the first `count` values of any buffer.
template <typename T>
std::vector<T> read(Recorder& recorder, const Buffer& from, std::size_t count) {
  const Buffer to(device(), "test read-back", count * sizeof(T), Buffer::Kind::readback);
  recorder.copy(from, to, count * sizeof(T));
  recorder.submit_and_wait();
  std::vector<T> values(count);
  if (count > 0) std::memcpy(values.data(), to.mapped(), count * sizeof(T));
  return values;
}

template <typename T>
void write(Recorder& recorder, const Buffer& to, const std::vector<T>& values) {
  if (values.empty()) return;
  const Buffer from = buffer_of(values);
  recorder.copy(from, to, values.size() * sizeof(T));
  recorder.submit_and_wait();
}

/// Room for `count` results, and past them words that no kernel may touch.
template <typename T>
class Output {
 public:
  explicit Output(std::size_t count)
      : count_(count),
        buffer_(device(), "test output", count * sizeof(T) + guard_bytes, Buffer::Kind::upload,
                vk::BufferUsageFlagBits::eShaderDeviceAddress) {
    std::memset(buffer_.mapped(), filler, buffer_.bytes());
  }
  [[nodiscard]] const Buffer& buffer() const { return buffer_; }
  [[nodiscard]] std::vector<T> values() const {
    const auto* bytes = static_cast<const unsigned char*>(buffer_.mapped());
    for (std::size_t i = count_ * sizeof(T); i < buffer_.bytes(); ++i)
      EXPECT_EQ(bytes[i], filler) << "written past the end, byte " << i;
    std::vector<T> result(count_);
    if (count_ > 0) std::memcpy(result.data(), bytes, count_ * sizeof(T));
    return result;
  }

 private:
  static constexpr std::size_t guard_bytes = 256;
  static constexpr unsigned char filler = 0xA5;
  std::size_t count_;
  Buffer buffer_;
};

/// Both sides of every boundary of a scan: invocation's run, block, two blocks, the spine's first and second run of
/// blocks.
inline std::vector<std::uint32_t> boundary_sizes() {
  constexpr std::uint32_t spine = gpu::SCAN_GROUP * gpu::SCAN_BLOCK;
  return {0,
          1,
          2,
          3,
          31,
          32,
          33,
          63,
          64,
          65,
          1023,
          1024,
          1025,
          2047,
          2048,
          2049,
          3000,
          spine - 1,
          spine,
          spine + 1,
          2 * spine - 1,
          2 * spine,
          2 * spine + 1,
          2 * spine + 3333};
}

inline std::uint32_t blocks_of(std::uint64_t items, std::uint32_t size = gpu::SCAN_BLOCK) {
  return static_cast<std::uint32_t>((items + size - 1) / size);
}

/// Words of an indirect-dispatch record that says so many workgroups, as shaders/lib/args.glsl folds them.
inline void set_args(std::vector<std::uint32_t>& args, std::uint32_t record, std::uint32_t groups) {
  args[std::size_t{record} * 3] = std::min(groups, 32768U);
  args[std::size_t{record} * 3 + 1] = (groups + 32767) / 32768;
  args[std::size_t{record} * 3 + 2] = 1;
}

struct TestRay {
  glm::vec3 origin{0}, direction{0, 0, 1};
  float tmin = 0, tmax = std::numeric_limits<float>::infinity();
  std::uint32_t pixel = 0, medium = 0;
};

/// As shaders/lists/rays.glsl lays out a list of `capacity` slots; slots past the rays hold none.
inline std::vector<float> pack_rays(const std::vector<TestRay>& rays, std::uint32_t capacity) {
  std::vector<float> words(std::size_t{gpu::RAY_WORDS + 1} * capacity, 0.0F);
  auto put = [&](std::uint32_t word, std::size_t slot, auto value) {
    static_assert(sizeof(value) == 4);
    const std::size_t part = word / gpu::RAY_PART * capacity + slot;
    std::memcpy(&words[part * gpu::RAY_PART + word % gpu::RAY_PART], &value, 4);
  };
  for (std::size_t i = 0; i < capacity; ++i) {
    const TestRay ray = i < rays.size() ? rays[i] : TestRay{};
    for (int c = 0; c < 3; ++c) put(gpu::RAY_ORIGIN + static_cast<std::uint32_t>(c), i, ray.origin[c]);
    for (int c = 0; c < 3; ++c) put(gpu::RAY_DIRECTION + static_cast<std::uint32_t>(c), i, ray.direction[c]);
    put(gpu::RAY_TMIN, i, ray.tmin);
    put(gpu::RAY_TMAX, i, ray.tmax);
    put(gpu::RAY_MEDIUM, i, ray.medium);
    const std::uint32_t pixel = i < rays.size() ? ray.pixel : gpu::NO_INDEX;
    std::memcpy(&words[std::size_t{gpu::RAY_WORDS} * capacity + i], &pixel, 4);
  }
  return words;
}

/// Deterministic, and the same with every standard library (whose distributions differ).
class Dice {
 public:
  explicit Dice(std::uint32_t seed) : engine_(seed) {}
  std::uint32_t word() { return static_cast<std::uint32_t>(engine_()); }
  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>((std::uint64_t{word()} * n) >> 32U); }
  double unit() { return (word() + 0.5) * 0x1p-32; }
  double range(double lo, double hi) { return lo + (hi - lo) * unit(); }
  double magnitude(double lo, double hi) { return std::exp(range(std::log(lo), std::log(hi))); }
  glm::dvec3 cube() {
    const double x = range(-1, 1), y = range(-1, 1), z = range(-1, 1);
    return {x, y, z};
  }
  glm::dvec3 direction() {
    for (;;) {
      const glm::dvec3 v = cube();
      const double size = glm::length(v);
      if (size > 0.01 && size < 1) return v / size;
    }
  }

 private:
  std::mt19937 engine_;
};

/// Some unit vector square to a unit vector.
inline glm::dvec3 square_to(const glm::dvec3& v) {
  return glm::normalize(glm::cross(v, std::abs(v.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
}

}  // namespace sheaf::test
