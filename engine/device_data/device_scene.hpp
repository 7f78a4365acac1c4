// SPDX-License-Identifier: MIT
// The scene on the device, and what of it must be touched for a frame: only what moved since the last one.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "device_data/scene_layout.hpp"
#include "scene/camera_path.hpp"
#include "scene/pose.hpp"
#include "vulkan/recorder.hpp"

namespace sheaf {

struct Motion {  // what a frame's animate and objects stages have to do; all zero when nothing moved
  std::uint32_t moved_instances = 0;
  std::uint32_t triangle_blocks = 0;  // in ROLE_ANIMATE_BLOCKS of animate_triangles
  std::uint32_t vertex_blocks = 0;    // in ROLE_ANIMATE_BLOCKS of animate_vertices
  std::vector<std::pair<std::uint32_t, std::uint32_t>>
      refit;  // (first, count) in the refit list, a height each, leaves first
};

class DeviceScene {
 public:
  /// Of the plan: object_hierarchy and transform_on_fetch. The scene must outlive it.
  DeviceScene(const Device& device, const Scene& scene, const RenderSettings& settings, const Plan& plan);

  /// Moves everything to a pose. `origin` is the frame origin; triangles are relative to it.
  [[nodiscard]] Motion update(const Pose& pose, const CameraView& camera, Recorder& recorder);
  void bind(Recorder& recorder) const;

  [[nodiscard]] const SceneLayout& layout() const { return layout_; }
  [[nodiscard]] const glm::dvec3& origin() const { return origin_; }
  [[nodiscard]] float box_pad() const { return box_pad_; }
  [[nodiscard]] std::uint32_t lights() const { return light_count_; }
  [[nodiscard]] std::uint32_t triangles() const { return static_cast<std::uint32_t>(layout_.triangles); }
  [[nodiscard]] const Buffer& triangle_work() const { return triangle_work_; }
  [[nodiscard]] const Buffer& vertex_work() const { return vertex_work_; }
  [[nodiscard]] const Buffer& refit_work() const { return refit_work_; }
  [[nodiscard]] const Buffer& triangle_words() const { return triangles_; }
  [[nodiscard]] bool transforms_on_fetch() const { return transform_on_fetch_; }  // then they have no corners
  /// What shaders read by address (memory.glsl), set in the frame's block.
  void set_addresses(gpu::Frame& frame) const;
  [[nodiscard]] std::uint32_t hierarchy_levels() const { return hierarchy_levels_; }
  [[nodiscard]] const Buffer& deforms() const { return deforms_; }
  [[nodiscard]] const std::vector<Box>& instance_boxes() const { return boxes_; }

 private:
  void place_instances(const Pose& pose, std::vector<bool>& moved);
  void place_skins(const Pose& pose, std::vector<bool>& moved);
  void place_lights(const Pose& pose, const CameraView& camera);
  void choose_origin(const Pose& pose, const CameraView& camera);
  void choose_pad(const CameraView& camera);
  void build_top_level(Recorder& recorder, std::vector<std::vector<std::uint32_t>>& heights);
  Motion list_work(const std::vector<bool>& moved, Recorder& recorder);

  const Scene& scene_;
  const bool hierarchy_, transform_on_fetch_;
  SceneLayout layout_;
  Buffer indices_, positions_, normals_, tangents_, uvs_, colors_, materials_, texels_;
  Buffer triangles_, instances_, lights_, nodes_, dynamic_;
  Buffer deforms_, joints_, morphs_, matrices_, weights_;
  Buffer triangle_work_, vertex_work_, refit_work_, top_staging_;
  std::vector<Box> boxes_;            // an instance: relative to the origin, near enough to build the top level
  std::vector<glm::dmat4> to_world_;  // an instance: its mesh relative to the origin; not of skinned ones
  std::vector<glm::vec3> light_positions_;
  glm::dvec3 origin_{0};
  float box_pad_ = 0;
  double grid_ = 1;  // the origin snaps to it, so that a moving camera does not move the whole scene
  std::uint32_t light_count_ = 0, hierarchy_levels_ = 0;
  bool fresh_ = true;
};

/// Uploads through a staging buffer and waits; an empty span gives a buffer of one word.
template <typename T>
[[nodiscard]] Buffer upload(const Device& device, Recorder& recorder, const char* name, const std::vector<T>& data,
                            vk::BufferUsageFlags extra = {}) {
  Buffer target(device, name, data.size() * sizeof(T), Buffer::Kind::device, extra);
  if (data.empty()) return target;
  const Buffer staging(device, name, data.size() * sizeof(T), Buffer::Kind::upload);
  std::memcpy(staging.mapped(), data.data(), data.size() * sizeof(T));
  recorder.copy(staging, target, data.size() * sizeof(T));
  recorder.submit_and_wait();
  return target;
}

}  // namespace sheaf
