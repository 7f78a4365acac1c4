// SPDX-License-Identifier: MIT
#include "scene.hpp"

#include <cstring>
#include <stdexcept>
#include <string>

namespace bench {
namespace {

void check(RTCDevice device, const char* what) {
  if (rtcGetDeviceError(device) != RTC_ERROR_NONE) throw std::runtime_error(std::string("Embree: ") + what);
}

// Light passes: the ray goes on. A renderer would sum what the surface takes away; here the crossing is counted in the
// ray's flags, which costs less.
void let_pass(const RTCFilterFunctionNArguments* arguments) {
  for (unsigned lane = 0; lane < arguments->N; ++lane) {
    if (arguments->valid[lane] == 0) continue;
    RTCRayN_flags(arguments->ray, arguments->N, lane) += 1;
    arguments->valid[lane] = 0;
  }
}

RTCBuildQuality quality_of(Update update, bool moves) {
  if (!moves) return RTC_BUILD_QUALITY_MEDIUM;
  if (update == Update::refit) return RTC_BUILD_QUALITY_REFIT;
  return update == Update::low ? RTC_BUILD_QUALITY_LOW : RTC_BUILD_QUALITY_MEDIUM;
}

bool two_levels(Update update) { return update == Update::refit || update == Update::low; }

}  // namespace

const char* name_of(Update update) {
  constexpr const char* names[] = {"none", "refit", "low", "rebuild"};
  return names[static_cast<int>(update)];
}

std::vector<std::uint8_t> classify(std::span<const oracle::Triangle> frame, std::span<const oracle::Triangle> next,
                                   std::span<const std::uint8_t> passes) {
  std::vector<std::uint8_t> part(frame.size());
  for (std::size_t i = 0; i < frame.size(); ++i) {
    const bool moves = std::memcmp(&frame[i], &next[i], sizeof(oracle::Triangle)) != 0;
    const bool pass = !passes.empty() && passes[i] != 0;
    part[i] = static_cast<std::uint8_t>((moves ? part_moves : 0) | (pass ? part_passes : 0));
  }
  return part;
}

EmbreeScene::EmbreeScene(RTCDevice device, Update update, std::span<const oracle::Triangle> triangles,
                         std::span<const std::uint8_t> part_of)
    : scene_(rtcNewScene(device)), update_(update) {
  rtcSetSceneFlags(scene_, two_levels(update) ? RTC_SCENE_FLAG_DYNAMIC : RTC_SCENE_FLAG_NONE);
  rtcSetSceneBuildQuality(scene_, two_levels(update) ? RTC_BUILD_QUALITY_LOW : RTC_BUILD_QUALITY_MEDIUM);
  for (std::size_t i = 0; i < part_of.size(); ++i) triangle_of_[part_of[i]].push_back(static_cast<std::uint32_t>(i));
  for (unsigned part = 0; part < parts; ++part) attach(device, part, triangles);
  rtcCommitScene(scene_);
  check(device, "the scene could not be built");
}

void EmbreeScene::attach(RTCDevice device, unsigned part, std::span<const oracle::Triangle> triangles) {
  const auto& members = triangle_of_[part];
  if (members.empty()) return;
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetGeometryBuildQuality(geometry, quality_of(update_, (part & part_moves) != 0));
  corners_[part] = static_cast<glm::vec3*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(glm::vec3), members.size() * 3));
  auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                 3 * sizeof(unsigned), members.size()));
  check(device, "no memory for the triangles");
  for (std::size_t i = 0; i < members.size() * 3; ++i) indices[i] = static_cast<unsigned>(i);
  for (std::size_t i = 0; i < members.size(); ++i)
    std::memcpy(corners_[part] + 3 * i, &triangles[members[i]], sizeof(oracle::Triangle));
  if ((part & part_passes) != 0) rtcSetGeometryOccludedFilterFunction(geometry, let_pass);
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene_, geometry, part);
  rtcReleaseGeometry(geometry);
  geometry_[part] = geometry;
}

EmbreeScene::~EmbreeScene() { rtcReleaseScene(scene_); }

void EmbreeScene::place(std::span<const oracle::Triangle> triangles) {
  for (unsigned part = part_moves; part < parts; part += 2)
    for (std::size_t i = 0; i < triangle_of_[part].size(); ++i)
      std::memcpy(corners_[part] + 3 * i, &triangles[triangle_of_[part][i]], sizeof(oracle::Triangle));
}

Took EmbreeScene::update() {
  const Clock clock;
  for (unsigned part = 0; part < parts; ++part) {
    if (geometry_[part] == nullptr || (part & part_moves) == 0) continue;
    rtcUpdateGeometryBuffer(geometry_[part], RTC_BUFFER_TYPE_VERTEX, 0);
    rtcCommitGeometry(geometry_[part]);
  }
  if (update_ != Update::none) rtcCommitScene(scene_);
  return clock.read();
}

}  // namespace bench
