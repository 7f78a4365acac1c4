// SPDX-License-Identifier: MIT
// llvmpipe's vectors have 256 bits unless LP_NATIVE_VECTOR_WIDTH, read when its first instance is made, says otherwise.
// Where the CPU takes 512 as readily, frames take 0.8 to 0.97 of the time with them.
#pragma once

#include <cstdint>
#include <string>
#include <vulkan/vulkan_raii.hpp>

namespace sheaf {

/// Whether that was measured to pay for a driver that calls itself so ("Mesa 25.0.7 (LLVM 15.0.6)"): from Mesa 25 on.
/// With Mesa 22.3 frames take 1.3 to 1.7 times as long.
[[nodiscard]] bool driver_gains_from_wide_vectors(const std::string& driver_info);

/// Whether LP_NATIVE_VECTOR_WIDTH is set, by the user or by suit_vectors().
[[nodiscard]] bool vector_width_is_given();

/// Where kernels with vectors of so many bits are kept: a folder of MESA_SHADER_CACHE_DIR, else of the user's caches.
/// Empty where there is neither.
[[nodiscard]] std::string kernel_cache_folder(std::uint32_t bits);

/// Asks for vectors of 512 bits where they pay and the user has not said how wide they are to be; and for a cache of
/// kernels of their own where they are not as wide as the driver's: it takes no account of the width there (seen with
/// Mesa 25.0.7: sorted lists came out wrong). True where that only holds for an instance made anew, with none
/// left of the old.
[[nodiscard]] bool suit_vectors(const vk::raii::PhysicalDevice& physical);

}  // namespace sheaf
