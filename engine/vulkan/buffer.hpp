// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

#include "vulkan/device.hpp"

namespace sheaf {

/// What a buffer that shaders read by address, or not at all, is made with: no binding's limit holds its size.
constexpr auto by_address = vk::BufferUsageFlagBits::eShaderDeviceAddress;

/// A storage buffer with its own memory. Host-visible ones stay mapped (coherent).
class Buffer {
 public:
  enum class Kind { device, upload, readback };  // device-local; written by the host; read by the host

  Buffer() = default;
  /// Zero bytes become one word, so that a role is never unbound. Throws Error{limit} when memory runs out.
  Buffer(const Device& device, const std::string& name, std::uint64_t bytes, Kind kind = Kind::device,
         vk::BufferUsageFlags extra = {});
  Buffer(Buffer&& other) noexcept { swap(other); }
  Buffer& operator=(Buffer&& other) noexcept {
    swap(other);
    return *this;
  }
  ~Buffer();

  [[nodiscard]] vk::Buffer handle() const { return *buffer_; }
  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }
  [[nodiscard]] explicit operator bool() const { return bytes_ != 0; }
  [[nodiscard]] void* mapped() const { return mapped_; }
  template <typename T>
  [[nodiscard]] std::span<T> view() const {
    return {static_cast<T*>(mapped_), static_cast<std::size_t>(bytes_ / sizeof(T))};
  }
  [[nodiscard]] vk::DeviceAddress address() const;
  /// The address, so many bytes on, low word first, as structures shared with shaders hold it.
  [[nodiscard]] glm::uvec2 address_words(std::uint64_t offset = 0) const;

 private:
  void swap(Buffer& other) noexcept;

  const Device* device_ = nullptr;
  vk::raii::Buffer buffer_{nullptr};
  vk::raii::DeviceMemory memory_{nullptr};
  std::uint64_t bytes_ = 0, allocated_ = 0;
  void* mapped_ = nullptr;
};

}  // namespace sheaf
