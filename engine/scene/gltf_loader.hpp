// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>

#include "scene/scene.hpp"

namespace sheaf {

struct LoadLimits {                                   // what one scene file may ask for; more is Error{limit}
  std::uint64_t file_bytes = std::uint64_t{4} << 30;  // every file read, together
  std::uint64_t triangles = 64'000'000;               // unique, before instancing
  std::uint64_t vertices = 128'000'000;
  std::uint64_t nodes = 1'000'000;
  std::uint64_t texture_bytes = std::uint64_t{4} << 30;  // decoded, RGBA8
  std::uint32_t image_side = 16384;
};

struct SceneChoice {
  std::string scene = {};    // empty for the file's default scene (else its first), a name, or an index
  std::string variant = {};  // of KHR_materials_variants: empty for none, a name, or an index
};

/// Reads a .glb or .gltf (buffers and images beside it or embedded) into a checked Scene.
/// Throws Error{input} naming the file, the object ("accessors[3]") and the reason; Error{io} where it can't be read;
/// Error{limit} past a limit. Unsupported names in extensionsRequired are Error{input}.
[[nodiscard]] Scene load_gltf(const std::string& path, const SceneChoice& choice = {}, const LoadLimits& limits = {});

}  // namespace sheaf
