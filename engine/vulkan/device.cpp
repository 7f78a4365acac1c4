// SPDX-License-Identifier: MIT
#include "vulkan/device.hpp"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <thread>

#include "core/error.hpp"
#include "vulkan/instance.hpp"
#include "vulkan/vector_width.hpp"

namespace sheaf {
namespace {

/// llvmpipe has a thread a core that this process may use, or as many as LP_NUM_THREADS says. A wrong guess costs time
/// alone.
std::uint32_t cpu_workers() {
  const char* said = std::getenv("LP_NUM_THREADS");
  const std::uint32_t given = said == nullptr ? 0 : static_cast<std::uint32_t>(std::strtoul(said, nullptr, 10));
  return std::clamp(given > 0 ? given : std::thread::hardware_concurrency(), 1U, 256U);
}

bool has_extension(const std::vector<vk::ExtensionProperties>& all, const char* name) {
  return std::any_of(all.begin(), all.end(), [&](const auto& e) { return std::strcmp(e.extensionName, name) == 0; });
}

std::uint32_t compute_graphics_family(const vk::raii::PhysicalDevice& physical) {
  const auto families = physical.getQueueFamilyProperties();
  const auto both = vk::QueueFlagBits::eCompute | vk::QueueFlagBits::eGraphics;
  for (std::uint32_t i = 0; i < families.size(); ++i)
    if ((families[i].queueFlags & both) == both && families[i].timestampValidBits > 0) return i;
  return VK_QUEUE_FAMILY_IGNORED;
}

bool supports_ray_query(const vk::raii::PhysicalDevice& physical,
                        const std::vector<vk::ExtensionProperties>& extensions) {
  if (!has_extension(extensions, VK_KHR_RAY_QUERY_EXTENSION_NAME) ||
      !has_extension(extensions, VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME) ||
      !has_extension(extensions, VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME))
    return false;
  const auto chain = physical.getFeatures2<vk::PhysicalDeviceFeatures2, vk::PhysicalDeviceRayQueryFeaturesKHR,
                                           vk::PhysicalDeviceAccelerationStructureFeaturesKHR>();
  return chain.get<vk::PhysicalDeviceRayQueryFeaturesKHR>().rayQuery != VK_FALSE &&
         chain.get<vk::PhysicalDeviceAccelerationStructureFeaturesKHR>().accelerationStructure != VK_FALSE;
}

void check_requirements(const vk::raii::PhysicalDevice& physical,
                        const std::vector<vk::ExtensionProperties>& extensions, DeviceSummary& summary) {
  const auto chain = physical.getFeatures2<vk::PhysicalDeviceFeatures2, vk::PhysicalDeviceVulkan12Features>();
  const auto& core = chain.get<vk::PhysicalDeviceFeatures2>().features;
  const auto& twelve = chain.get<vk::PhysicalDeviceVulkan12Features>();
  auto need = [&](bool present, const char* what) {
    if (!present) summary.lacks.emplace_back(what);
  };
  need(physical.getProperties().apiVersion >= VK_API_VERSION_1_2, "Vulkan 1.2");
  need(core.shaderInt64 != VK_FALSE, "shaderInt64");
  need(core.vertexPipelineStoresAndAtomics != VK_FALSE && core.fragmentStoresAndAtomics != VK_FALSE,
       "storage buffers in the raster pipeline");
  need(twelve.scalarBlockLayout != VK_FALSE, "scalarBlockLayout");
  need(twelve.bufferDeviceAddress != VK_FALSE, "bufferDeviceAddress");
  need(twelve.shaderBufferInt64Atomics != VK_FALSE, "shaderBufferInt64Atomics");
  need(has_extension(extensions, VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME), "VK_KHR_push_descriptor");
  need(compute_graphics_family(physical) != VK_QUEUE_FAMILY_IGNORED,
       "a queue for graphics and compute with timestamps");
}

DeviceSummary summarise(const vk::raii::PhysicalDevice& physical, std::uint32_t index) {
  DeviceSummary summary;
  summary.index = index;
  const auto extensions = physical.enumerateDeviceExtensionProperties();
  const auto chain = physical.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceDriverProperties,
                                             vk::PhysicalDeviceSubgroupProperties>();
  const auto& properties = chain.get<vk::PhysicalDeviceProperties2>().properties;
  const auto& driver = chain.get<vk::PhysicalDeviceDriverProperties>();
  summary.name = properties.deviceName.data();
  summary.driver = std::string(driver.driverName.data()) + " " + driver.driverInfo.data();
  summary.kind = vk::to_string(properties.deviceType);
  std::transform(summary.kind.begin(), summary.kind.end(), summary.kind.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  summary.api = std::to_string(VK_API_VERSION_MAJOR(properties.apiVersion)) + "." +
                std::to_string(VK_API_VERSION_MINOR(properties.apiVersion)) + "." +
                std::to_string(VK_API_VERSION_PATCH(properties.apiVersion));
  summary.subgroup = chain.get<vk::PhysicalDeviceSubgroupProperties>().subgroupSize;
  const auto memory = physical.getMemoryProperties();
  for (std::uint32_t i = 0; i < memory.memoryHeapCount; ++i)
    if (memory.memoryHeaps[i].flags & vk::MemoryHeapFlagBits::eDeviceLocal)
      summary.memory_mib = std::max<std::uint64_t>(summary.memory_mib, memory.memoryHeaps[i].size >> 20);
  check_requirements(physical, extensions, summary);
  summary.ray_query = supports_ray_query(physical, extensions);
  summary.usable = summary.lacks.empty();
  return summary;
}

int preference(const vk::raii::PhysicalDevice& physical) {
  switch (physical.getProperties().deviceType) {
    case vk::PhysicalDeviceType::eDiscreteGpu:
      return 4;
    case vk::PhysicalDeviceType::eIntegratedGpu:
      return 3;
    case vk::PhysicalDeviceType::eVirtualGpu:
      return 2;
    case vk::PhysicalDeviceType::eCpu:
      return 1;
    default:
      return 0;
  }
}

std::string reasons(const std::vector<DeviceSummary>& all) {
  std::string text;
  for (const auto& summary : all) {
    text += "; " + std::to_string(summary.index) + " " + summary.name;
    if (summary.usable) continue;
    text += " lacks";
    for (const auto& what : summary.lacks) text += " " + what + ",";
    text.pop_back();
  }
  return text;
}

std::uint32_t choose(const std::vector<vk::raii::PhysicalDevice>& physical, const std::vector<DeviceSummary>& all,
                     const std::string& selector) {
  if (all.empty())
    throw Error(ErrorKind::device, "Vulkan: no device found (install a driver, for example Mesa's lavapipe)");
  std::uint32_t wanted = 0;
  const auto* end = selector.data() + selector.size();
  const bool is_index = !selector.empty() && std::from_chars(selector.data(), end, wanted).ptr == end;
  std::uint32_t best = VK_QUEUE_FAMILY_IGNORED;
  for (std::uint32_t i = 0; i < all.size(); ++i) {
    if (!all[i].usable) continue;
    if (is_index ? i != wanted : !selector.empty() && all[i].name.find(selector) == std::string::npos) continue;
    if (best == VK_QUEUE_FAMILY_IGNORED || preference(physical[i]) > preference(physical[best])) best = i;
  }
  if (best == VK_QUEUE_FAMILY_IGNORED)
    throw Error(ErrorKind::device,
                "Vulkan: no usable device" + (selector.empty() ? "" : " matches '" + selector + "'") + reasons(all));
  return best;
}

struct Opened {
  vk::raii::Instance instance;
  std::vector<vk::raii::PhysicalDevice> devices;
  std::vector<DeviceSummary> summaries;

  Opened(const vk::raii::Context& context, Validation validation)
      : instance(make_instance(context, validation)), devices(instance.enumeratePhysicalDevices()) {
    for (std::uint32_t i = 0; i < devices.size(); ++i) summaries.push_back(summarise(devices[i], i));
  }
};

// A driver reads its environment again only where no instance is left of the old.
void open_anew(std::unique_ptr<Opened>& opened, const vk::raii::Context& context, Validation validation) {
  opened.reset();
  opened = std::make_unique<Opened>(context, validation);
}

}  // namespace

std::vector<DeviceSummary> Device::list() {
  vk::raii::Context context;
  auto opened = std::make_unique<Opened>(context, Validation::off);
  if (std::any_of(opened->devices.begin(), opened->devices.end(), suit_vectors))
    open_anew(opened, context, Validation::off);
  return opened->summaries;
}

Device::Device(const std::string& selector) {
  const Validation validation = validation_wanted();
  auto opened = std::make_unique<Opened>(context_, validation);
  std::uint32_t chosen = choose(opened->devices, opened->summaries, selector);
  if (suit_vectors(opened->devices[chosen])) {
    open_anew(opened, context_, validation);
    chosen = choose(opened->devices, opened->summaries, std::to_string(chosen));
  }
  instance_ = std::move(opened->instance);
  if (validation != Validation::off) messenger_ = make_messenger(instance_);
  physical_ = std::move(opened->devices[chosen]);
  summary_ = std::move(opened->summaries[chosen]);
  queue_family_ = compute_graphics_family(physical_);

  const auto properties = physical_.getProperties();
  limits_.subgroup = summary_.subgroup;
  limits_.storage_range = properties.limits.maxStorageBufferRange;
  limits_.groups_x = properties.limits.maxComputeWorkGroupCount[0];
  limits_.timestamp_ns = properties.limits.timestampPeriod;
  limits_.cpu = properties.deviceType == vk::PhysicalDeviceType::eCpu;
  if (limits_.cpu) {
    limits_.workers = cpu_workers();
    // Eight vectors. Four of 16 lanes take 1.07 of the time in Sponza, 16 of eight 1.2.
    limits_.bundle = std::max(limits_.bundle, 8 * limits_.subgroup);
  }
  limits_.ray_query = summary_.ray_query;
  making_waits_ = limits_.cpu && vector_width_is_given();

  const float priority = 1;
  vk::DeviceQueueCreateInfo queue_info({}, queue_family_, 1, &priority);
  std::vector<const char*> extensions{VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME};
  vk::PhysicalDeviceFeatures core;
  core.shaderInt64 = core.vertexPipelineStoresAndAtomics = core.fragmentStoresAndAtomics = VK_TRUE;
  vk::PhysicalDeviceVulkan12Features twelve;
  twelve.scalarBlockLayout = twelve.shaderBufferInt64Atomics = twelve.bufferDeviceAddress = VK_TRUE;
  twelve.subgroupBroadcastDynamicId = VK_TRUE;  // which every Vulkan 1.2 has
  vk::PhysicalDeviceAccelerationStructureFeaturesKHR structures;
  vk::PhysicalDeviceRayQueryFeaturesKHR query;
  if (limits_.ray_query) {
    for (const char* name : {VK_KHR_RAY_QUERY_EXTENSION_NAME, VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME,
                             VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME})
      extensions.push_back(name);
    structures.accelerationStructure = VK_TRUE;
    query.rayQuery = VK_TRUE;
    query.pNext = &structures;
    twelve.pNext = &query;
  }
  vk::DeviceCreateInfo info({}, queue_info, {}, extensions, &core);
  info.pNext = &twelve;
  try {
    device_ = vk::raii::Device(physical_, info);
  } catch (const vk::SystemError& error) {
    throw Error(ErrorKind::device, "Vulkan: " + summary_.name + ": " + error.what());
  }
  queue_ = vk::raii::Queue(device_, queue_family_, 0);
  pipeline_cache_ = vk::raii::PipelineCache(device_, vk::PipelineCacheCreateInfo{});
}

Device::~Device() = default;

std::shared_lock<std::shared_mutex> Device::while_making() const {
  return making_waits_ ? std::shared_lock(making_or_working_) : std::shared_lock<std::shared_mutex>();
}

std::unique_lock<std::shared_mutex> Device::while_working() const {
  return making_waits_ ? std::unique_lock(making_or_working_) : std::unique_lock<std::shared_mutex>();
}

std::uint32_t Device::memory_type(std::uint32_t allowed, vk::MemoryPropertyFlags wanted) const {
  const auto memory = physical_.getMemoryProperties();
  for (std::uint32_t i = 0; i < memory.memoryTypeCount; ++i)
    if ((allowed >> i & 1U) != 0 && (memory.memoryTypes[i].propertyFlags & wanted) == wanted) return i;
  throw Error(ErrorKind::device, summary_.name + ": no memory type " + vk::to_string(wanted));
}

std::uint64_t Device::validation_messages() { return sheaf::validation_messages(); }

void Device::account(std::int64_t bytes) const {
  const std::int64_t now = held_.fetch_add(bytes) + bytes;
  std::uint64_t peak = peak_.load();
  while (static_cast<std::int64_t>(peak) < now && !peak_.compare_exchange_weak(peak, static_cast<std::uint64_t>(now))) {
  }
}

}  // namespace sheaf
