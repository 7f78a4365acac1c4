// SPDX-License-Identifier: MIT
// A frame as one single-part scanline OpenEXR file. The same layers and attributes give the same bytes.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "output/compression.hpp"

namespace sheaf {

/// Width × height pixels, row 0 at the top. An empty vector is a layer that is left out of the file.
/// Half channels are clamped to ±65504 and NaN becomes 0 there; float channels are written as they are.
struct FrameLayers {
  std::uint32_t width = 0, height = 0;
  std::vector<float> rgba;                            // 4 a pixel: R G B A, half; linear Rec.709, premultiplied
  std::vector<float> depth;                           // Z, float: distance along the view axis in metres
  std::vector<float> normal;                          // 3 a pixel: N.X N.Y N.Z, float, world space
  std::vector<float> position;                        // 3 a pixel: P.X P.Y P.Z, float, world space
  std::vector<float> albedo;                          // 3 a pixel: albedo.R albedo.G albedo.B, half
  std::vector<float> uv;                              // 2 a pixel: UV.X UV.Y, float
  std::vector<std::uint32_t> object_id, material_id;  // id.object, id.material
  std::vector<float> tests;                           // tests, float: intersection tests that the pixel cost
};

struct FrameAttributes {
  /// Both act on column vectors, as everywhere in GLM; the file holds OpenEXR's row vectors (p' = p · M), whose matrix
  /// is the transpose in row-major order: the same sixteen numbers in memory. world_to_camera is glTF's: right-handed,
  /// looking along -Z, +Y up. The file's worldToCamera is left-handed, looking along +Z, as the standard attribute is
  /// defined: the writer negates camera z.
  glm::dmat4 world_to_camera{1};
  /// To OpenEXR's NDC, not to clip space: x right, y DOWN, (0,0) the upper left and (1,1) the lower right corner of the
  /// image, after division by w.
  glm::dmat4 world_to_ndc{1};
  double fps = 24;
  std::int64_t frame = 0;
  double time_s = 0;
  std::string scene_sha256, settings_json, strategy, version;
};

/// Throws Error{io} with the path and the reason. Layers whose size is not width × height, attributes that OpenEXR
/// cannot hold, and a compression_conflict are Error{usage}.
void write_exr(const std::string& path, const FrameLayers& layers, const FrameAttributes& attributes,
               Compression compression);

/// True if the file opens, is a scanline image of this size, and every chunk is there and decodes. Never throws.
[[nodiscard]] bool exr_is_whole(const std::string& path, std::uint32_t width, std::uint32_t height) noexcept;

}  // namespace sheaf
