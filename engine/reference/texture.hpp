// SPDX-License-Identifier: MIT
// Texture lookups in double precision (SHADING.md: Material at a point, Texture filter).
#pragma once

#include <map>
#include <vector>

#include "scene/scene.hpp"

namespace sheaf::reference {

struct UvFootprint {  // a point, and the diameters of the ellipse around it; zero: the point alone
  glm::dvec2 at{0}, along{0}, across{0};
};

enum class TexelKind : std::uint32_t { number, color, color_by_alpha };

class Textures {
 public:
  /// Makes the smaller levels of every texture that the scene's materials use.
  Textures(const Scene& scene, bool opaque);

  /// RGBA, 0…1: the image itself at the point. White where `use` has no texture.
  [[nodiscard]] glm::dvec4 at(const TextureUse& use, const UvFootprint& uv0, const UvFootprint& uv1,
                              TexelKind kind) const;
  /// The mean over the footprint.
  [[nodiscard]] glm::dvec4 mean(const TextureUse& use, const UvFootprint& uv0, const UvFootprint& uv1,
                                TexelKind kind) const;
  [[nodiscard]] TexelKind base_kind(const Material& material) const;

 private:
  struct Level {
    std::int64_t width = 0, height = 0;
    std::vector<glm::vec4> values;  // of level 0: none, they are in the image
  };
  using Levels = std::vector<Level>;

  void prepare(const TextureUse& use, TexelKind kind);
  [[nodiscard]] const Image* image_of(const TextureUse& use) const;
  [[nodiscard]] glm::dvec4 texel(const Image& image, const Level& level, std::int64_t x, std::int64_t y,
                                 const Texture& texture, TexelKind kind) const;
  [[nodiscard]] glm::dvec4 filtered(const Image& image, const Level& level, const Texture& texture,
                                    const glm::dvec2& uv, TexelKind kind, bool nearest) const;

  const Scene& scene_;
  bool opaque_;
  std::map<std::pair<std::uint32_t, TexelKind>, Levels> levels_;  // an image and how its texels are read
};

}  // namespace sheaf::reference
