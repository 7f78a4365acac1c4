// SPDX-License-Identifier: MIT
#include "vulkan/recorder.hpp"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "core/error.hpp"

namespace sheaf {

Recorder::Recorder(const Device& device) : device_(device), unbound_(device, "unbound role", 16) {
  bound_.fill(unbound_.handle());
  pool_ = vk::raii::CommandPool(device.logical(),
                                {vk::CommandPoolCreateFlagBits::eResetCommandBuffer, device.queue_family()});
  commands_ =
      std::move(vk::raii::CommandBuffers(device.logical(), {*pool_, vk::CommandBufferLevel::ePrimary, 1}).front());
  fence_ = vk::raii::Fence(device.logical(), vk::FenceCreateInfo{});
  queries_ = vk::raii::QueryPool(device.logical(), vk::QueryPoolCreateInfo({}, vk::QueryType::eTimestamp, max_marks));
}

void Recorder::begin() {
  if (recording_) return;
  commands_.reset();
  commands_.begin({vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
  commands_.resetQueryPool(*queries_, 0, max_marks);
  recording_ = true;
  marks_.clear();
  barrier();
  if (current_ != nullptr) mark(current_);
}

void Recorder::mark(const char* name) {
  commands_.writeTimestamp(vk::PipelineStageFlagBits::eBottomOfPipe, *queries_,
                           static_cast<std::uint32_t>(marks_.size()));
  marks_.push_back(name);
  // llvmpipe takes the time when the stamp's scene is flushed, which a barrier does; without it the next dispatch comes
  // first.
  barrier();
}

void Recorder::stage(const char* name) {
  if (recording_ && marks_.size() + 2 >= max_marks) submit_and_wait();
  const bool same = recording_ && current_ != nullptr && std::strcmp(current_, name) == 0;
  current_ = name;
  if (!recording_)
    begin();
  else if (!same)
    mark(name);
}

void Recorder::bind_roles(const PipelineLayout& layout, vk::PipelineBindPoint point, const void* push,
                          std::size_t bytes, vk::ShaderStageFlags stages) {
  std::array<vk::DescriptorBufferInfo, ROLE_COUNT> infos;
  std::vector<vk::WriteDescriptorSet> writes;
  writes.reserve(layout.roles().size());
  const vk::WriteDescriptorSetAccelerationStructureKHR structure(1, &structure_);
  for (const auto role : layout.roles()) {
    if (role == ROLE_STRUCTURE) {
      writes.emplace_back(vk::DescriptorSet{}, role, 0, 1, vk::DescriptorType::eAccelerationStructureKHR);
      writes.back().pNext = &structure;
      continue;
    }
    infos[role] = vk::DescriptorBufferInfo(bound_[role], 0, VK_WHOLE_SIZE);
    writes.emplace_back(vk::DescriptorSet{}, role, 0, 1, vk::DescriptorType::eStorageBuffer, nullptr, &infos[role]);
  }
  commands_.pushDescriptorSetKHR(point, layout.handle(), 0, writes);
  std::array<std::uint32_t, push_bytes / 4> words{};
  static_assert(PUSH_LISTS + sizeof(lists_) <= push_bytes);
  std::memcpy(words.data(), push, bytes);
  std::memcpy(&words[PUSH_LISTS / 4], lists_.data(), sizeof(lists_));
  commands_.pushConstants<std::uint32_t>(layout.handle(), stages, 0, words);
}

void Recorder::prepare(const Kernel& kernel, const void* push, std::size_t bytes) {
  if (!kernel) throw std::logic_error("dispatch of a kernel that the plan left out");
  begin();
  commands_.bindPipeline(vk::PipelineBindPoint::eCompute, kernel.pipeline());
  bind_roles(kernel.layout(), vk::PipelineBindPoint::eCompute, push, bytes, vk::ShaderStageFlagBits::eCompute);
  ++dispatches_;
}

void Recorder::dispatch_bytes(const Kernel& kernel, const void* push, std::size_t bytes, std::uint64_t groups) {
  if (groups == 0) return;
  prepare(kernel, push, bytes);
  constexpr std::uint64_t row = 32768;  // within every device's limit; shaders unfold it (global_group in common.glsl)
  const std::uint64_t x = std::min(groups, row), y = (groups + row - 1) / row;
  commands_.dispatch(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), 1);
  barrier();
}

void Recorder::indirect_bytes(const Kernel& kernel, const void* push, std::size_t bytes, std::uint32_t args) {
  prepare(kernel, push, bytes);
  commands_.dispatchIndirect(bound_[ROLE_ARGS], args * 12ULL);
  barrier();
}

void Recorder::fill(const Buffer& buffer, std::uint32_t value, std::uint64_t offset, std::uint64_t bytes) {
  begin();
  commands_.fillBuffer(buffer.handle(), offset, bytes, value);
  barrier();
}

void Recorder::copy(const Buffer& from, const Buffer& to, std::uint64_t bytes, std::uint64_t from_offset,
                    std::uint64_t to_offset) {
  if (bytes == 0) return;
  begin();
  commands_.copyBuffer(from.handle(), to.handle(), vk::BufferCopy(from_offset, to_offset, bytes));
  barrier();
}

void Recorder::update(const Buffer& buffer, const void* data, std::uint64_t bytes) {
  begin();
  commands_.updateBuffer<std::byte>(buffer.handle(), 0,
                                    {static_cast<std::uint32_t>(bytes), static_cast<const std::byte*>(data)});
  barrier();
}

void Recorder::barrier() {
  begin();
  using Stage = vk::PipelineStageFlagBits;
  using Access = vk::AccessFlagBits;
  const vk::MemoryBarrier all(Access::eShaderWrite | Access::eTransferWrite | Access::eHostWrite,
                              Access::eShaderRead | Access::eShaderWrite | Access::eTransferRead |
                                  Access::eTransferWrite | Access::eIndirectCommandRead | Access::eHostRead);
  const auto from = Stage::eComputeShader | Stage::eTransfer | Stage::eHost | Stage::eAllGraphics;
  const auto to = from | Stage::eDrawIndirect;
  commands_.pipelineBarrier(from, to, {}, all, {}, {});
}

void Recorder::submit_and_wait() {
  if (!recording_) return;
  mark("");  // closes the last stage
  commands_.end();
  recording_ = false;
  try {
    const auto working = device_.while_working();
    device_.queue().submit(vk::SubmitInfo({}, {}, *commands_), *fence_);
    if (const auto call = std::exchange(at_submit_, nullptr)) call();
    const auto result = device_.logical().waitForFences(*fence_, VK_TRUE, UINT64_MAX);
    if (result != vk::Result::eSuccess) throw Error(ErrorKind::device, "Vulkan: wait: " + vk::to_string(result));
    device_.logical().resetFences(*fence_);
  } catch (const vk::SystemError& error) {
    throw Error(ErrorKind::device, device_.summary().name + ": " + error.what());
  }
  const auto count = static_cast<std::uint32_t>(marks_.size());
  const auto stamps = queries_
                          .getResults<std::uint64_t>(0, count, count * sizeof(std::uint64_t), sizeof(std::uint64_t),
                                                     vk::QueryResultFlagBits::e64 | vk::QueryResultFlagBits::eWait)
                          .second;
  for (std::uint32_t i = 0; i + 1 < count; ++i)
    if (*marks_[i] != '\0')
      times_[marks_[i]] += static_cast<double>(stamps[i + 1] - stamps[i]) * device_.limits().timestamp_ns * 1e-6;
}

std::map<std::string, double> Recorder::take_times() { return std::exchange(times_, {}); }

}  // namespace sheaf
