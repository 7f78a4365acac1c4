// SPDX-License-Identifier: MIT
#include "vulkan/instance.hpp"

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <vector>

#include "core/error.hpp"

namespace sheaf {
namespace {

std::atomic<std::uint64_t> message_count{0};

VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                          VkDebugUtilsMessageTypeFlagsEXT,
                                          const VkDebugUtilsMessengerCallbackDataEXT* data, void*) {
  // While it sets itself up the layer tells, as a warning, what features it turned on for its own use.
  const std::string_view text = data->pMessage;
  if (text.find("UNASSIGNED-GPU-Assisted Validation Warning") != std::string_view::npos) return VK_FALSE;
  if (severity >= VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT) {
    message_count.fetch_add(1);
    std::fprintf(stderr, "vulkan validation: %s\n", data->pMessage);
  }
  return VK_FALSE;
}

}  // namespace

Validation validation_wanted() {
  const char* value = std::getenv("SHEAF_VALIDATION");
  const std::string_view wanted = value == nullptr ? "" : value;
  if (wanted.empty() || wanted == "0") return Validation::off;
  return wanted == "gpu" ? Validation::gpu_assisted : Validation::on;
}

vk::raii::Instance make_instance(const vk::raii::Context& context, Validation validation) {
  vk::ApplicationInfo application("sheaf", 1, "sheaf", 1, VK_API_VERSION_1_2);
  std::vector<const char*> layers, extensions;
  std::vector<vk::ValidationFeatureEnableEXT> more;
  if (validation != Validation::off) {
    layers.push_back("VK_LAYER_KHRONOS_validation");
    extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
    more.push_back(vk::ValidationFeatureEnableEXT::eSynchronizationValidation);
  }
  if (validation == Validation::gpu_assisted) {
    more.push_back(vk::ValidationFeatureEnableEXT::eGpuAssisted);
    more.push_back(vk::ValidationFeatureEnableEXT::eGpuAssistedReserveBindingSlot);
  }
  const vk::ValidationFeaturesEXT features(more);
  vk::InstanceCreateInfo info({}, &application, layers, extensions);
  if (!more.empty()) info.pNext = &features;
  try {
    return {context, info};
  } catch (const vk::LayerNotPresentError&) {
    throw Error(ErrorKind::device, "Vulkan: SHEAF_VALIDATION is set but the validation layer is not installed");
  } catch (const vk::SystemError& error) {
    throw Error(ErrorKind::device, std::string("Vulkan: no instance (is a driver installed?): ") + error.what());
  }
}

vk::raii::DebugUtilsMessengerEXT make_messenger(const vk::raii::Instance& instance) {
  using Severity = vk::DebugUtilsMessageSeverityFlagBitsEXT;
  using Type = vk::DebugUtilsMessageTypeFlagBitsEXT;
  VkDebugUtilsMessengerCreateInfoEXT info{};
  info.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT;
  info.messageSeverity = static_cast<VkFlags>(Severity::eWarning | Severity::eError);
  info.messageType = static_cast<VkFlags>(Type::eGeneral | Type::eValidation);
  info.pfnUserCallback = on_message;
  return {instance, vk::DebugUtilsMessengerCreateInfoEXT(info)};
}

std::uint64_t validation_messages() { return message_count.load(); }

}  // namespace sheaf
