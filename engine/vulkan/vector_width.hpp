// SPDX-License-Identifier: MIT
// llvmpipe's vectors have 256 bits unless LP_NATIVE_VECTOR_WIDTH, read when its first instance is made, says otherwise.
// Where the CPU takes 512 as readily, frames take 0.8 to 0.97 of the time with them.
#pragma once

#include <string>
#include <vulkan/vulkan_raii.hpp>

namespace sheaf {

/// Whether that was measured to pay for a driver that calls itself so ("Mesa 25.0.7 (LLVM 15.0.6)"): from Mesa 25 on.
/// With Mesa 22.3 frames take 1.3 to 1.7 times as long.
[[nodiscard]] bool driver_gains_from_wide_vectors(const std::string& driver_info);

/// Asks for vectors of 512 bits where they pay and the user has not said how wide they are to be. True where only an
/// instance made anew has them.
[[nodiscard]] bool widen_vectors(const vk::raii::Instance& instance);

}  // namespace sheaf
