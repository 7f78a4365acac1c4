// SPDX-License-Identifier: MIT
// A compute pipeline and the buffer roles its SPIR-V reads. Roles are binding numbers that mean the same in every
// shader, so the layout comes from the code itself and a dispatch needs no list of bindings.
#pragma once

#include <cstdint>
#include <future>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "vulkan/device.hpp"

namespace sheaf {

/// SPIR-V of shaders/STEM, embedded at build time. Throws std::logic_error for a stem that does not exist.
[[nodiscard]] std::span<const std::uint32_t> shader_code(std::string_view stem);

/// Binding numbers a module declares, ascending.
[[nodiscard]] std::vector<std::uint32_t> declared_roles(std::span<const std::uint32_t> spirv);

struct SpecConstant {
  std::uint32_t id;
  std::uint32_t value;
};

inline constexpr std::uint32_t push_bytes = 128;

class PipelineLayout {  // push descriptors for the roles, push constants of push_bytes
 public:
  PipelineLayout() = default;
  PipelineLayout(const Device& device, std::vector<std::uint32_t> roles, vk::ShaderStageFlags stages);
  [[nodiscard]] vk::PipelineLayout handle() const { return *layout_; }
  [[nodiscard]] const std::vector<std::uint32_t>& roles() const { return roles_; }

 private:
  std::vector<std::uint32_t> roles_;
  vk::raii::DescriptorSetLayout set_{nullptr};
  vk::raii::PipelineLayout layout_{nullptr};
};

[[nodiscard]] vk::raii::ShaderModule make_shader_module(const Device& device, std::string_view stem);

/// Made on a thread of its own: drivers translate a shader for a hundredth of a second or more, and a frame needs
/// dozens.
class Kernel {
 public:
  Kernel() = default;
  Kernel(const Device& device, std::string_view stem, std::span<const SpecConstant> constants = {});
  [[nodiscard]] explicit operator bool() const { return !stem_.empty(); }
  [[nodiscard]] const std::string& stem() const { return stem_; }
  /// Waits until it is made; rethrows what went wrong then.
  [[nodiscard]] vk::Pipeline pipeline() const { return *made_.get().pipeline; }
  /// Whether `pipeline` need not wait; true of none.
  [[nodiscard]] bool made() const;
  /// CPU time that it took to be made, of its thread; waits as `pipeline` does.
  [[nodiscard]] double making_ms() const { return made_.valid() ? made_.get().cpu_ms : 0; }
  [[nodiscard]] const PipelineLayout& layout() const { return layout_; }

 private:
  struct Made {
    vk::raii::Pipeline pipeline;
    double cpu_ms;
  };
  std::string stem_;
  PipelineLayout layout_;
  std::shared_future<Made> made_;
};

}  // namespace sheaf
