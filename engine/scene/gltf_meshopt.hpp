// SPDX-License-Identifier: MIT
// bufferViews that are compressed by EXT_meshopt_compression or KHR_meshopt_compression.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <vector>

namespace sheaf {

struct GltfFile;

struct PackedView {
  const char* extension = nullptr;
  const nlohmann::json* object = nullptr;  // the extension's: where the compressed bytes are, and how to read them
  explicit operator bool() const { return object != nullptr; }
};

/// The extension of a bufferView that says where its compressed bytes are; false where it has none.
[[nodiscard]] PackedView packed_view(const nlohmann::json& view);

/// Decompresses bufferView `index`. `budget`: bytes that may still be decompressed, from which its size is taken.
[[nodiscard]] std::vector<std::uint8_t> unpack_view(const GltfFile& file, std::size_t index, const PackedView& packed,
                                                    std::span<const std::uint8_t> stream, std::uint64_t& budget);

}  // namespace sheaf
