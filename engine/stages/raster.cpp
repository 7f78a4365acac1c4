// SPDX-License-Identifier: MIT
#include "stages/raster.hpp"

#include <algorithm>
#include <array>

namespace sheaf {
namespace {

constexpr auto both_stages = vk::ShaderStageFlagBits::eVertex | vk::ShaderStageFlagBits::eFragment;

std::vector<std::uint32_t> roles_of_both() {
  auto roles = declared_roles(shader_code("raster_vert"));
  const auto more = declared_roles(shader_code("raster_frag"));
  roles.insert(roles.end(), more.begin(), more.end());
  std::sort(roles.begin(), roles.end());
  roles.erase(std::unique(roles.begin(), roles.end()), roles.end());
  return roles;
}

}  // namespace

Raster::Raster(const Device& device, const Plan& plan, const Features& features) : device_(device) {
  if (RasterSpans::pays(device))
    spans_ = RasterSpans(device, plan, features);
  else
    make_pipeline(plan, features);
}

void Raster::make_pipeline(const Plan& plan, const Features& features) {
  const Device& device = device_;
  layout_ = PipelineLayout(device, roles_of_both(), both_stages);
  // No attachments: what a fragment finds goes to the visibility buffer by a 64-bit minimum.
  const vk::SubpassDescription subpass({}, vk::PipelineBindPoint::eGraphics);
  pass_ = vk::raii::RenderPass(device.logical(), vk::RenderPassCreateInfo({}, {}, subpass));

  const auto vertex = make_shader_module(device, "raster_vert"), fragment = make_shader_module(device, "raster_frag");
  const std::array entries{
      vk::SpecializationMapEntry(SPEC_MASKED, 0, 4), vk::SpecializationMapEntry(SPEC_TRANSFORM_ON_FETCH, 4, 4),
      vk::SpecializationMapEntry(SPEC_ONE_SIDED, 8, 4), vk::SpecializationMapEntry(SPEC_RANKED, 12, 4)};
  const std::array<vk::Bool32, 4> values{features.masked, plan.transform_on_fetch, features.one_sided,
                                         features.coincident};
  const vk::SpecializationInfo special(entries.size(), entries.data(), sizeof(values), values.data());
  const std::array stages{
      vk::PipelineShaderStageCreateInfo({}, vk::ShaderStageFlagBits::eVertex, *vertex, "main", &special),
      vk::PipelineShaderStageCreateInfo({}, vk::ShaderStageFlagBits::eFragment, *fragment, "main", &special)};
  const vk::PipelineVertexInputStateCreateInfo input;
  const vk::PipelineInputAssemblyStateCreateInfo assembly({}, vk::PrimitiveTopology::eTriangleList);
  const vk::PipelineViewportStateCreateInfo viewport({}, 1, nullptr, 1, nullptr);
  vk::PipelineRasterizationStateCreateInfo raster;  // no culling: fragments know which backs count
  raster.lineWidth = 1;
  const vk::PipelineMultisampleStateCreateInfo multisample;
  const vk::PipelineColorBlendStateCreateInfo blend;
  const std::array dynamic{vk::DynamicState::eViewport, vk::DynamicState::eScissor};
  const vk::PipelineDynamicStateCreateInfo dynamics({}, dynamic);
  vk::GraphicsPipelineCreateInfo info({}, stages, &input, &assembly, nullptr, &viewport, &raster, &multisample, nullptr,
                                      &blend, &dynamics, layout_.handle(), *pass_);
  const auto making = device.while_making();
  pipeline_ = vk::raii::Pipeline(device.logical(), device.pipeline_cache(), info);
}

const vk::raii::Framebuffer& Raster::framebuffer(std::uint32_t width, std::uint32_t height) {
  auto found = framebuffers_.find({width, height});
  if (found == framebuffers_.end()) {
    vk::FramebufferCreateInfo info({}, *pass_, 0, nullptr, width, height, 1);
    found = framebuffers_.emplace(std::pair{width, height}, vk::raii::Framebuffer(device_.logical(), info)).first;
  }
  return found->second;
}

void Raster::record(Recorder& recorder, const DeviceScene& scene, const RayMemory& memory, const Tile& tile,
                    std::uint32_t width, std::uint32_t height) {
  recorder.stage("raster");
  recorder.fill(memory.visibility, 0xFFFFFFFFU, 0, std::uint64_t{tile.pixels()} * 8);
  if (scene.triangles() == 0) return;
  recorder.bind(ROLE_VISIBILITY, memory.visibility);
  if (spans_) {
    spans_.record(recorder, memory.visibility, scene.triangles());
    return;
  }
  const auto& commands = recorder.commands();
  const vk::Rect2D area({0, 0}, {tile.width, tile.height});
  commands.beginRenderPass(vk::RenderPassBeginInfo(*pass_, *framebuffer(tile.width, tile.height), area),
                           vk::SubpassContents::eInline);
  commands.bindPipeline(vk::PipelineBindPoint::eGraphics, *pipeline_);
  const std::uint32_t unused = 0;
  recorder.bind_roles(layout_, vk::PipelineBindPoint::eGraphics, &unused, sizeof(unused), both_stages);
  // The viewport is the whole image's, moved so that the tile's first pixel is at 0.
  commands.setViewport(0, vk::Viewport(-static_cast<float>(tile.x), -static_cast<float>(tile.y),
                                       static_cast<float>(width), static_cast<float>(height), 0, 1));
  commands.setScissor(0, area);
  commands.draw(scene.triangles() * 3, 1, 0, 0);
  commands.endRenderPass();
  recorder.barrier();
}

}  // namespace sheaf
