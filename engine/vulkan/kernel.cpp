// SPDX-License-Identifier: MIT
#include "vulkan/kernel.hpp"

#include <algorithm>
#include <chrono>

#include "core/cpu_time.hpp"
#include "interface/shared.h"

namespace sheaf {

std::vector<std::uint32_t> declared_roles(std::span<const std::uint32_t> spirv) {
  constexpr std::uint32_t header_words = 5, op_decorate = 71, decoration_binding = 33;
  std::vector<std::uint32_t> roles;
  for (std::size_t at = header_words; at < spirv.size();) {
    const std::uint32_t words = spirv[at] >> 16, op = spirv[at] & 0xFFFFU;
    if (op == op_decorate && words == 4 && spirv[at + 2] == decoration_binding) roles.push_back(spirv[at + 3]);
    at += std::max(words, 1U);
  }
  std::sort(roles.begin(), roles.end());
  roles.erase(std::unique(roles.begin(), roles.end()), roles.end());
  return roles;
}

namespace {

vk::raii::Pipeline make_pipeline(const Device& device, std::string_view stem, vk::PipelineLayout layout,
                                 std::span<const SpecConstant> constants) {
  const auto module = make_shader_module(device, stem);
  std::vector<vk::SpecializationMapEntry> entries;
  std::vector<std::uint32_t> values;
  for (const auto& constant : constants) {
    entries.emplace_back(constant.id, static_cast<std::uint32_t>(values.size() * 4), 4);
    values.push_back(constant.value);
  }
  const vk::SpecializationInfo special(static_cast<std::uint32_t>(entries.size()), entries.data(), values.size() * 4,
                                       values.data());
  const vk::PipelineShaderStageCreateInfo stage({}, vk::ShaderStageFlagBits::eCompute, *module, "main", &special);
  return {device.logical(), device.pipeline_cache(), vk::ComputePipelineCreateInfo({}, stage, layout)};
}

}  // namespace

PipelineLayout::PipelineLayout(const Device& device, std::vector<std::uint32_t> roles, vk::ShaderStageFlags stages)
    : roles_(std::move(roles)) {
  std::vector<vk::DescriptorSetLayoutBinding> bindings;
  for (const auto role : roles_)
    bindings.emplace_back(
        role,
        role == ROLE_STRUCTURE ? vk::DescriptorType::eAccelerationStructureKHR : vk::DescriptorType::eStorageBuffer, 1,
        stages);
  set_ = vk::raii::DescriptorSetLayout(device.logical(),
                                       {vk::DescriptorSetLayoutCreateFlagBits::ePushDescriptorKHR, bindings});
  const vk::PushConstantRange range(stages, 0, push_bytes);
  layout_ = vk::raii::PipelineLayout(device.logical(), vk::PipelineLayoutCreateInfo({}, *set_, range));
}

vk::raii::ShaderModule make_shader_module(const Device& device, std::string_view stem) {
  const auto code = shader_code(stem);
  return {device.logical(), vk::ShaderModuleCreateInfo({}, code.size_bytes(), code.data())};
}

Kernel::Kernel(const Device& device, std::string_view stem, std::span<const SpecConstant> constants)
    : stem_(stem), layout_(device, declared_roles(shader_code(stem)), vk::ShaderStageFlagBits::eCompute) {
  std::vector given(constants.begin(), constants.end());
  given.push_back({SPEC_WORKERS, device.limits().workers});
  given.push_back({SPEC_BUNDLE, device.limits().bundle});
  auto make = [&device, stem = stem_, layout = layout_.handle(), given = std::move(given)] {
    const BesideDevice beside;
    const auto making = device.while_making();
    const double begun = thread_cpu_ms();
    auto pipeline = make_pipeline(device, stem, layout, given);
    return Made{std::move(pipeline), thread_cpu_ms() - begun};
  };
  made_ = std::async(std::launch::async, std::move(make)).share();
}

bool Kernel::made() const {
  return !made_.valid() || made_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

}  // namespace sheaf
