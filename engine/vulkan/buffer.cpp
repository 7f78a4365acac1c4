// SPDX-License-Identifier: MIT
#include "vulkan/buffer.hpp"

#include <algorithm>
#include <utility>

#include "core/error.hpp"

namespace sheaf {

Buffer::Buffer(const Device& device, const std::string& name, std::uint64_t bytes, Kind kind,
               vk::BufferUsageFlags extra)
    : device_(&device), bytes_(std::max<std::uint64_t>((bytes + 3) / 4 * 4, 16)) {
  using Usage = vk::BufferUsageFlagBits;
  using Property = vk::MemoryPropertyFlagBits;
  const auto usage = Usage::eStorageBuffer | Usage::eTransferSrc | Usage::eTransferDst | Usage::eIndirectBuffer | extra;
  const bool addressed = static_cast<bool>(extra & by_address);
  if (bytes_ > device.limits().storage_range && !addressed)
    throw limit_error(name, std::to_string(bytes_) + " bytes exceed the device's largest storage buffer (" +
                                std::to_string(device.limits().storage_range) + ")");
  constexpr std::uint64_t most_by_address = std::uint64_t{1} << 32U;  // offsets in shaders are 32 bits (memory.glsl)
  if (bytes_ > most_by_address && addressed)
    throw limit_error(name, std::to_string(bytes_) + " bytes exceed " + std::to_string(most_by_address));
  try {
    buffer_ = vk::raii::Buffer(device.logical(), vk::BufferCreateInfo({}, bytes_, usage));
    const auto needs = buffer_.getMemoryRequirements();
    vk::MemoryPropertyFlags wanted = Property::eDeviceLocal;
    if (kind == Kind::upload) wanted = Property::eHostVisible | Property::eHostCoherent;
    if (kind == Kind::readback) wanted = Property::eHostVisible | Property::eHostCoherent;
    vk::MemoryAllocateFlagsInfo flags(vk::MemoryAllocateFlagBits::eDeviceAddress);
    vk::MemoryAllocateInfo info(needs.size, device.memory_type(needs.memoryTypeBits, wanted));
    if (addressed) info.pNext = &flags;
    memory_ = vk::raii::DeviceMemory(device.logical(), info);
    buffer_.bindMemory(*memory_, 0);
    allocated_ = needs.size;
    if (kind != Kind::device) mapped_ = memory_.mapMemory(0, VK_WHOLE_SIZE);
  } catch (const vk::SystemError& error) {
    throw limit_error(name, std::to_string(bytes_ >> 20) + " MiB of device memory: " + error.what());
  }
  device.account(static_cast<std::int64_t>(allocated_));
}

Buffer::~Buffer() {
  if (device_ != nullptr) device_->account(-static_cast<std::int64_t>(allocated_));
}

vk::DeviceAddress Buffer::address() const { return device_->logical().getBufferAddress({*buffer_}); }

glm::uvec2 Buffer::address_words(std::uint64_t offset) const {
  const vk::DeviceAddress at = address() + offset;
  return {static_cast<std::uint32_t>(at), static_cast<std::uint32_t>(at >> 32U)};
}

void Buffer::swap(Buffer& other) noexcept {
  std::swap(device_, other.device_);
  std::swap(buffer_, other.buffer_);
  std::swap(memory_, other.memory_);
  std::swap(bytes_, other.bytes_);
  std::swap(allocated_, other.allocated_);
  std::swap(mapped_, other.mapped_);
}

}  // namespace sheaf
