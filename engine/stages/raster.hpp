// SPDX-License-Identifier: MIT
// Raster (R 4.1): the graphics pipeline finds the first hits of a tile into a visibility buffer of (t, triangle); on
// CPU devices a kernel does (raster_spans).
#pragma once

#include "device_data/device_scene.hpp"
#include "device_data/ray_lists.hpp"
#include "device_data/tile.hpp"
#include "stages/raster_spans.hpp"
#include "vulkan/kernel.hpp"

namespace sheaf {

class Raster {
 public:
  Raster(const Device& device, const Plan& plan, const Features& features);
  void record(Recorder& recorder, const DeviceScene& scene, const RayMemory& memory, const Tile& tile,
              std::uint32_t width, std::uint32_t height);

 private:
  void make_pipeline(const Plan& plan, const Features& features);
  const vk::raii::Framebuffer& framebuffer(std::uint32_t width, std::uint32_t height);

  const Device& device_;
  RasterSpans spans_;
  PipelineLayout layout_;
  vk::raii::RenderPass pass_{nullptr};
  vk::raii::Pipeline pipeline_{nullptr};
  std::map<std::pair<std::uint32_t, std::uint32_t>, vk::raii::Framebuffer> framebuffers_;
};

}  // namespace sheaf
