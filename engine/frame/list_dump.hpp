// SPDX-License-Identifier: MIT
// Reads a traced list back for `--dump`.
#pragma once

#include "device_data/device_scene.hpp"
#include "device_data/ray_lists.hpp"
#include "frame/dump_writer.hpp"
#include "vulkan/kernel.hpp"
#include "vulkan/recorder.hpp"

namespace sheaf {

class ListDump {
 public:
  ListDump(const Device& device, const DeviceScene& scene, const RayMemory& memory);
  /// The frame's triangles, once they are on the device.
  void triangles(Recorder& recorder, DumpWriter& writer);
  /// `slots`: not 0 where the list has no order, being whole.
  void list(Recorder& recorder, DumpWriter& writer, const RayList& list, std::uint32_t kind, std::uint32_t generation,
            std::uint32_t slots);

 private:
  void read_triangles(Recorder& recorder, std::size_t first, std::size_t count);
  [[nodiscard]] HitRecord record_of(const float* ray, std::uint32_t triangle, float t) const;

  const DeviceScene& scene_;
  const RayMemory& memory_;
  bool ranked_;  // surfaces lie in one place
  Kernel corners_;
  Buffer triangles_, rays_, hits_, order_, counters_;
  std::vector<float> host_corners_;  // 9 a triangle
};

}  // namespace sheaf
