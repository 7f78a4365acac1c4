// SPDX-License-Identifier: MIT
// Primitives that KHR_draco_mesh_compression compresses.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scene/gltf_accessor.hpp"
#include "scene/gltf_file.hpp"

namespace sheaf {

struct DracoPrimitive {
  DecodedAccessors accessors;          // of the attributes that are compressed
  std::vector<std::uint32_t> indices;  // three for each triangle, whatever the primitive's mode
};

/// Decompresses primitive `p` of mesh `m`; nothing where it is not compressed, or its extension cannot be read by this
/// build. `place` names the primitive.
[[nodiscard]] std::optional<DracoPrimitive> read_draco(const GltfFile& file, std::size_t m, std::size_t p,
                                                       const std::string& place);

}  // namespace sheaf
