// SPDX-License-Identifier: MIT
#include "vulkan/vector_width.hpp"

#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <string_view>

#if defined(__x86_64__)
#include <cpuid.h>
#endif

namespace sheaf {
namespace {

constexpr const char* width_variable = "LP_NATIVE_VECTOR_WIDTH";
constexpr const char* cache_variable = "MESA_SHADER_CACHE_DIR";
constexpr std::uint32_t own_bits = 256, wide_bits = 512;

// AMD's from Zen 5 (family 26) on. Before, 512 bits take two turns; and for most of Intel's LLVM halves such vectors.
bool cpu_computes_512_bits_at_once() {
#if defined(__x86_64__)
  unsigned a = 0, b = 0, c = 0, d = 0;
  if (!__builtin_cpu_is("amd") || __get_cpuid(1, &a, &b, &c, &d) == 0) return false;
  const unsigned family = (a >> 8U & 15U) + (a >> 20U & 255U);
  return family >= 26 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
         __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
#else
  return false;
#endif
}

std::string environment(const char* name) {
  const char* const value = std::getenv(name);
  return value != nullptr ? value : "";
}

}  // namespace

bool driver_gains_from_wide_vectors(const std::string& driver_info) {
  constexpr std::string_view name = "Mesa ";
  constexpr unsigned first_release = 25;
  const auto at = driver_info.find(name);
  if (at == std::string::npos) return false;
  unsigned release = 0;
  const char* const begin = driver_info.data() + at + name.size();
  return std::from_chars(begin, driver_info.data() + driver_info.size(), release).ec == std::errc{} &&
         release >= first_release;
}

bool vector_width_is_given() { return std::getenv(width_variable) != nullptr; }

std::string kernel_cache_folder(std::uint32_t bits) {
  std::string given = environment(cache_variable);
  const std::string own = "/vectors_" + std::to_string(bits);
  if (given.ends_with(own)) return given;
  if (!given.empty()) return given + own;
  const std::string caches = environment("XDG_CACHE_HOME"), home = environment("HOME");
  if (!caches.empty()) return caches + "/sheaf" + own;
  return home.empty() ? "" : home + "/.cache/sheaf" + own;
}

bool suit_vectors(const vk::raii::PhysicalDevice& physical) {
  const auto chain = physical.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceDriverProperties,
                                             vk::PhysicalDeviceSubgroupProperties>();
  const auto& driver = chain.get<vk::PhysicalDeviceDriverProperties>();
  if (driver.driverID != vk::DriverId::eMesaLlvmpipe) return false;
  const std::uint32_t bits = chain.get<vk::PhysicalDeviceSubgroupProperties>().subgroupSize * 32;
  const bool given = vector_width_is_given();
  const bool widens = !given && bits == own_bits && cpu_computes_512_bits_at_once() &&
                      driver_gains_from_wide_vectors(driver.driverInfo.data());
  // What the driver takes by itself, also on a CPU with less than AVX, it keeps in its own place.
  if (!widens && (!given || bits == own_bits)) return false;
  const std::uint32_t wanted = widens ? wide_bits : bits;
  const std::string folder = kernel_cache_folder(wanted);
  if (folder.empty() || folder == environment(cache_variable)) return false;
  std::error_code ignored;  // then kernels are not kept
  std::filesystem::create_directories(folder, ignored);
  ::setenv(cache_variable, folder.c_str(), 1);
  ::setenv(width_variable, std::to_string(wanted).c_str(), 1);
  return true;
}

}  // namespace sheaf
