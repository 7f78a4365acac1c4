// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sheaf {

struct GltfContainer {
  std::string_view json;
  std::span<const std::uint8_t> binary;  // the .glb's BIN chunk, empty where it has none
  std::vector<std::string> oddities;     // what breaks the format's rules though it can be read
};

/// Tells .glb from .gltf by its first bytes and checks every chunk against the file's size. Views into `bytes`. What is
/// neither is refused by the name of what it is.
[[nodiscard]] GltfContainer check_container(std::span<const std::uint8_t> bytes, const std::string& file);

/// Parses JSON that nests no deeper than any real glTF does: later readers recurse over it.
[[nodiscard]] nlohmann::json parse_json(std::string_view text, const std::string& file);

}  // namespace sheaf
