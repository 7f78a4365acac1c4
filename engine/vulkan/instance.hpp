// SPDX-License-Identifier: MIT
// The Vulkan instance, and the validation layer that SHEAF_VALIDATION asks for: 1, or with more checks than the plain
// layer's, `sync` (hazards between commands) or `gpu` (shaders' own accesses, checked while they run). Every message of
// it is printed and counted.
#pragma once

#include <cstdint>
#include <vulkan/vulkan_raii.hpp>

namespace sheaf {

enum class Validation { off, on, gpu_assisted };

[[nodiscard]] Validation validation_wanted();

/// Throws Error{device} where there is no driver, or no layer that was asked for.
[[nodiscard]] vk::raii::Instance make_instance(const vk::raii::Context& context, Validation validation);

[[nodiscard]] vk::raii::DebugUtilsMessengerEXT make_messenger(const vk::raii::Instance& instance);

/// Warnings and errors so far, of all instances of the process.
[[nodiscard]] std::uint64_t validation_messages();

}  // namespace sheaf
