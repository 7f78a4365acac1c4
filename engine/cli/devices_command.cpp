// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "cli/commands.hpp"
#include "core/error.hpp"
#include "vulkan/device.hpp"

namespace sheaf {

int run_devices(bool json) {
  const auto devices = Device::list();
  if (json) {
    auto list = nlohmann::ordered_json::array();
    for (const auto& d : devices)
      list.push_back({{"index", d.index},
                      {"name", d.name},
                      {"driver", d.driver},
                      {"kind", d.kind},
                      {"api", d.api},
                      {"subgroup", d.subgroup},
                      {"memory_mib", d.memory_mib},
                      {"usable", d.usable},
                      {"ray_query", d.ray_query},
                      {"lacks", d.lacks}});
    std::printf("%s\n", list.dump(2).c_str());
  } else {
    for (const auto& d : devices) {
      std::printf("%u  %s (%s, Vulkan %s)\n   %s; subgroups of %u; %llu MiB; ray query: %s\n", d.index, d.name.c_str(),
                  d.kind.c_str(), d.api.c_str(), d.driver.c_str(), d.subgroup,
                  static_cast<unsigned long long>(d.memory_mib), d.ray_query ? "yes" : "no");
      for (const auto& what : d.lacks) std::printf("   not usable: lacks %s\n", what.c_str());
    }
  }
  if (std::none_of(devices.begin(), devices.end(), [](const auto& d) { return d.usable; }))
    throw Error(ErrorKind::device, devices.empty()
                                       ? "Vulkan: no device found (install a driver, for example Mesa's lavapipe)"
                                       : "Vulkan: none of the devices is usable");
  return 0;
}

}  // namespace sheaf
