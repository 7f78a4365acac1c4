// SPDX-License-Identifier: MIT
// A dumped frame's triangles in Embree, and what its hierarchy costs when they move.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "api.hpp"
#include "clock.hpp"
#include "truth.hpp"

namespace bench {

/// How the hierarchy follows what moves. What stays is built once, with RTC_BUILD_QUALITY_MEDIUM, in the first three.
enum class Update {
  none,     // nothing moves: one level, built once
  refit,    // two levels; RTC_BUILD_QUALITY_REFIT for what moves
  low,      // two levels; RTC_BUILD_QUALITY_LOW (Morton order) for what moves
  rebuild,  // one level, everything anew with RTC_BUILD_QUALITY_MEDIUM
};
const char* name_of(Update update);

/// Which triangles are geometries of their own.
enum : std::uint8_t { part_moves = 1, part_passes = 2, parts = 4 };

/// For each triangle, the bits above: `passes` (may be empty: none) tells where light may pass.
std::vector<std::uint8_t> classify(std::span<const oracle::Triangle> frame, std::span<const oracle::Triangle> next,
                                   std::span<const std::uint8_t> passes);

class EmbreeScene {
 public:
  EmbreeScene(RTCDevice device, Update update, std::span<const oracle::Triangle> triangles,
              std::span<const std::uint8_t> part_of);
  ~EmbreeScene();
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  /// The corners of another frame. An application would have its animation write there: no part of update().
  void place(std::span<const oracle::Triangle> triangles);
  /// The hierarchy for the corners placed last.
  Took update();

  [[nodiscard]] RTCScene scene() const { return scene_; }
  /// The triangle's number in the dump.
  [[nodiscard]] std::int32_t triangle(unsigned geometry, unsigned primitive) const {
    return static_cast<std::int32_t>(triangle_of_[geometry][primitive]);
  }

 private:
  void attach(RTCDevice device, unsigned part, std::span<const oracle::Triangle> triangles);
  RTCScene scene_;
  Update update_;
  std::array<RTCGeometry, parts> geometry_{};
  std::array<glm::vec3*, parts> corners_{};
  std::array<std::vector<std::uint32_t>, parts> triangle_of_;
};

}  // namespace bench
