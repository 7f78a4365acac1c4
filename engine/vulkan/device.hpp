// SPDX-License-Identifier: MIT
// The Vulkan instance, the chosen physical device and its one queue. Everything on the device hangs off this.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <shared_mutex>
#include <string>
#include <vector>
#include <vulkan/vulkan_raii.hpp>

namespace sheaf {

struct DeviceSummary {  // what `sheaf devices` shows
  std::uint32_t index = 0;
  std::string name, driver, kind, api;
  std::uint32_t subgroup = 0;
  std::uint64_t memory_mib = 0;
  bool usable = false, ray_query = false;
  std::vector<std::string> lacks;  // why it is not usable
};

struct DeviceLimits {
  std::uint32_t subgroup = 8;
  std::uint64_t storage_range = 0;  // bytes one storage buffer binding may span
  std::uint32_t groups_x = 65535;
  float timestamp_ns = 1;
  bool cpu = false;
  std::uint32_t workers = 0;  // threads of a CPU device, between which it divides a dispatch (remap_workgroup.h)
  std::uint32_t bundle = 64;  // rays of a bundle of `hybrid`
  bool ray_query = false;
};

class Device {
 public:
  /// `selector`: empty (the best usable one: discrete, integrated, virtual, CPU), an index, or part of a name.
  /// Throws Error{device} that says for each device why it was not taken.
  explicit Device(const std::string& selector);
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;
  ~Device();

  [[nodiscard]] static std::vector<DeviceSummary> list();

  [[nodiscard]] const vk::raii::Device& logical() const { return device_; }
  [[nodiscard]] const vk::raii::PhysicalDevice& physical() const { return physical_; }
  [[nodiscard]] const vk::raii::Queue& queue() const { return queue_; }
  [[nodiscard]] std::uint32_t queue_family() const { return queue_family_; }
  [[nodiscard]] const DeviceLimits& limits() const { return limits_; }
  [[nodiscard]] const DeviceSummary& summary() const { return summary_; }
  [[nodiscard]] const vk::raii::PipelineCache& pipeline_cache() const { return pipeline_cache_; }

  /// First memory type of `allowed` with all `wanted` flags; throws Error{device} when there is none.
  [[nodiscard]] std::uint32_t memory_type(std::uint32_t allowed, vk::MemoryPropertyFlags wanted) const;

  /// Validation messages seen so far (only counted where the layer is on: SHEAF_VALIDATION=1).
  [[nodiscard]] static std::uint64_t validation_messages();

  /// Held while a kernel is made, and while the queue works. Where a variable gives the width of llvmpipe's vectors,
  /// the two exclude each other: the queue compiles what it meets first, finds that width anew each time, and for a
  /// moment takes it for the driver's own. A kernel made in that moment is wrong, and kept in the cache (seen with
  /// Mesa 25.0.7).
  [[nodiscard]] std::shared_lock<std::shared_mutex> while_making() const;
  [[nodiscard]] std::unique_lock<std::shared_mutex> while_working() const;

  /// Device memory now held and its peak, bytes; buffers and images report here.
  void account(std::int64_t bytes) const;
  [[nodiscard]] std::uint64_t peak_bytes() const { return peak_.load(); }
  [[nodiscard]] std::uint64_t held_bytes() const { return static_cast<std::uint64_t>(held_.load()); }

 private:
  vk::raii::Context context_;
  vk::raii::Instance instance_{nullptr};
  vk::raii::DebugUtilsMessengerEXT messenger_{nullptr};
  vk::raii::PhysicalDevice physical_{nullptr};
  vk::raii::Device device_{nullptr};
  vk::raii::Queue queue_{nullptr};
  vk::raii::PipelineCache pipeline_cache_{nullptr};
  std::uint32_t queue_family_ = 0;
  DeviceLimits limits_;
  DeviceSummary summary_;
  bool making_waits_ = false;
  mutable std::shared_mutex making_or_working_;
  mutable std::atomic<std::int64_t> held_{0};
  mutable std::atomic<std::uint64_t> peak_{0};
};

}  // namespace sheaf
