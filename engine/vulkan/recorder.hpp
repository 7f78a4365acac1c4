// SPDX-License-Identifier: MIT
// The one path by which work reaches the device: roles are bound to buffers, kernels dispatched, stages timed.
// Every dispatch is followed by a full memory barrier unless it says otherwise; a frame is a chain of stages.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "interface/push/push.h"
#include "interface/shared.h"
#include "vulkan/buffer.hpp"
#include "vulkan/kernel.hpp"

namespace sheaf {

class Recorder {
 public:
  explicit Recorder(const Device& device);

  void bind(std::uint32_t role, const Buffer& buffer) { bound_[role] = buffer.handle(); }
  void bind(std::uint32_t role, vk::Buffer buffer) { bound_[role] = buffer; }
  /// A part of a list (one of LIST_…), which kernels know by its address.
  void bind_list(std::uint32_t list, const Buffer& part) { lists_[list] = part.address(); }

  void bind_structure(vk::AccelerationStructureKHR structure) { structure_ = structure; }

  /// Device time from here on counts for this stage.
  void stage(const char* name);

  /// `groups` workgroups; more than the device's limit in x are folded into y.
  template <typename Push>
  void dispatch(const Kernel& kernel, const Push& push, std::uint64_t groups) {
    static_assert(gpu::is_push<Push>, "declared in shaders/interface/push");
    dispatch_bytes(kernel, &push, sizeof(Push), groups);
  }
  /// Workgroups from record `args` (one of ARGS_…) of the buffer bound to ROLE_ARGS.
  template <typename Push>
  void dispatch_indirect(const Kernel& kernel, const Push& push, std::uint32_t args) {
    static_assert(gpu::is_push<Push>, "declared in shaders/interface/push");
    indirect_bytes(kernel, &push, sizeof(Push), args);
  }

  void fill(const Buffer& buffer, std::uint32_t value, std::uint64_t offset = 0, std::uint64_t bytes = VK_WHOLE_SIZE);
  void copy(const Buffer& from, const Buffer& to, std::uint64_t bytes, std::uint64_t from_offset = 0,
            std::uint64_t to_offset = 0);
  /// At most 64 KiB, taken now.
  void update(const Buffer& buffer, const void* data, std::uint64_t bytes);
  void barrier();

  [[nodiscard]] const vk::raii::CommandBuffer& commands() const { return commands_; }
  [[nodiscard]] const Device& device() const { return device_; }
  /// Binds a pipeline's roles and push constants (graphics passes do the rest themselves).
  void bind_roles(const PipelineLayout& layout, vk::PipelineBindPoint point, const void* push, std::size_t bytes,
                  vk::ShaderStageFlags stages);

  /// Called once, between the next submit and its wait; may be empty.
  void at_next_submit(std::function<void()> call) { at_submit_ = std::move(call); }
  /// Runs what was recorded and waits. Throws Error{device} when the device is lost.
  void submit_and_wait();

  /// Milliseconds a stage since the last call of take_times.
  [[nodiscard]] const std::map<std::string, double>& times() const { return times_; }
  [[nodiscard]] std::map<std::string, double> take_times();
  [[nodiscard]] std::uint64_t dispatches() const { return dispatches_; }

 private:
  void begin();
  void dispatch_bytes(const Kernel& kernel, const void* push, std::size_t bytes, std::uint64_t groups);
  void indirect_bytes(const Kernel& kernel, const void* push, std::size_t bytes, std::uint32_t args);
  void prepare(const Kernel& kernel, const void* push, std::size_t bytes);
  void mark(const char* name);

  static constexpr std::uint32_t max_marks = 4096;
  const Device& device_;
  vk::raii::CommandPool pool_{nullptr};
  vk::raii::CommandBuffer commands_{nullptr};
  vk::raii::Fence fence_{nullptr};
  vk::raii::QueryPool queries_{nullptr};
  Buffer unbound_;  // stands in for roles that a kernel declares but its variant never reads
  std::array<vk::Buffer, ROLE_COUNT> bound_{};
  std::array<vk::DeviceAddress, LIST_COUNT> lists_{};
  vk::AccelerationStructureKHR structure_;
  std::vector<const char*> marks_;
  const char* current_ = nullptr;
  std::map<std::string, double> times_;
  std::function<void()> at_submit_;
  std::uint64_t dispatches_ = 0;
  bool recording_ = false;
};

}  // namespace sheaf
