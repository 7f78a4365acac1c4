// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "scene/gltf_file.hpp"
#include "scene/scene.hpp"

namespace sheaf {

/// Decodes these images of the file (PNG and JPEG of any depth and channels, and what image_codec.hpp has) to RGBA8,
/// several at a time.
[[nodiscard]] std::vector<Image> decode_images(const GltfFile& file, const std::vector<std::uint32_t>& images);

}  // namespace sheaf
