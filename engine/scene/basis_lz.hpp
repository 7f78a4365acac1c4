// SPDX-License-Identifier: MIT
// ETC1S images supercompressed by BasisLZ (KTX 2.0, BasisLZ/ETC1S Bitstream Specification).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace sheaf {

/// Symbols by canonical codes of at most 16 bits, as in Deflate.
struct HuffmanTable {
  std::array<std::uint16_t, 17> counts{};  // of codes by their length
  std::vector<std::uint16_t> symbols;      // in the order of their codes
};

struct BasisCodebooks {
  struct Endpoint {
    std::array<std::uint8_t, 3> color{};  // five bits each
    std::uint8_t intensity = 0;
  };
  std::vector<Endpoint> endpoints;
  std::vector<std::array<std::uint8_t, 4>> selectors;  // rows of four texels, of two bits each
  HuffmanTable endpoint_prediction, endpoint_delta, selector, selector_run;
  std::uint32_t history_size = 0;
};

struct BasisImage {  // within its level's bytes
  std::uint32_t flags = 0, color_offset = 0, color_length = 0, alpha_offset = 0, alpha_length = 0;
};

struct BasisGlobal {
  BasisCodebooks codebooks;
  BasisImage first;  // of the finest level
};

/// The global data of a file with `image_count` images; nothing where it is damaged.
[[nodiscard]] std::optional<BasisGlobal> read_basis_global(std::span<const std::uint8_t> data,
                                                           std::uint64_t image_count);

/// Writes channel c of a slice's texels to the channels that `channels` has bits for. False: the slice is damaged.
/// `source` is the channel of the slice for those, or 3 where each takes its own.
[[nodiscard]] bool decode_basis_slice(const BasisCodebooks& codebooks, std::span<const std::uint8_t> slice,
                                      unsigned channels, unsigned source, Image& image);

}  // namespace sheaf
