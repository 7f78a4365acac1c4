// SPDX-License-Identifier: MIT
// Draco's meshes (bitstream 2.2, sequential and edgebreaker) as plain arrays, by libdraco where the build has it.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace sheaf {

struct DracoAttribute {
  std::uint32_t id = 0;    // the unique id in the compressed data
  int component_type = 0;  // as glTF numbers them: values are converted to it
  int width = 0;           // components of a value, as many as the compressed data must have
};

struct DracoLimits {
  std::uint64_t triangles = 0, vertices = 0;
  std::uint64_t bytes = 0;  // of all attributes that the data holds, asked for or not
};

struct DracoMesh {
  std::string fault;        // why there is no mesh; empty: there is
  bool over_limit = false;  // the fault is that of a limit
  std::size_t vertices = 0;
  std::vector<std::uint32_t> indices;                 // three for each triangle
  std::vector<std::vector<std::uint8_t>> attributes;  // those asked for, without gaps
};

/// Counts are checked against the limits, and against the data's size, before memory is taken for them.
[[nodiscard]] DracoMesh decode_draco(std::span<const std::uint8_t> data, const std::vector<DracoAttribute>& wanted,
                                     const DracoLimits& limits);

}  // namespace sheaf
