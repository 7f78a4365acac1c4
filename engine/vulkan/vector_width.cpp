// SPDX-License-Identifier: MIT
#include "vulkan/vector_width.hpp"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <string_view>

#if defined(__x86_64__)
#include <cpuid.h>
#endif

namespace sheaf {
namespace {

constexpr const char* variable = "LP_NATIVE_VECTOR_WIDTH";
constexpr const char* wide = "512";
constexpr std::uint32_t narrow_lanes = 256 / 32;

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

bool gains(const vk::raii::PhysicalDevice& physical) {
  const auto chain = physical.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceDriverProperties,
                                             vk::PhysicalDeviceSubgroupProperties>();
  const auto& driver = chain.get<vk::PhysicalDeviceDriverProperties>();
  return driver.driverID == vk::DriverId::eMesaLlvmpipe &&
         chain.get<vk::PhysicalDeviceSubgroupProperties>().subgroupSize == narrow_lanes &&
         driver_gains_from_wide_vectors(driver.driverInfo.data());
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

bool widen_vectors(const vk::raii::Instance& instance) {
  if (std::getenv(variable) != nullptr || !cpu_computes_512_bits_at_once()) return false;
  const auto devices = instance.enumeratePhysicalDevices();
  return std::any_of(devices.begin(), devices.end(), gains) && ::setenv(variable, wide, 0) == 0;
}

}  // namespace sheaf
