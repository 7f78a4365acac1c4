// SPDX-License-Identifier: MIT
#include "reference/texture.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace sheaf::reference {
namespace {

double decode_srgb(double c) { return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); }

const std::array<double, 256>& srgb_table() {
  static const auto table = [] {
    std::array<double, 256> t{};
    for (std::size_t i = 0; i < t.size(); ++i) t[i] = decode_srgb(static_cast<double>(i) / 255);
    return t;
  }();
  return table;
}

std::int64_t wrapped(std::int64_t i, std::int64_t size, Wrap mode) {
  if (mode == Wrap::clamp_to_edge) return std::clamp<std::int64_t>(i, 0, size - 1);
  const std::int64_t period = mode == Wrap::mirrored_repeat ? 2 * size : size;
  const std::int64_t m = (i % period + period) % period;
  return m < size ? m : period - 1 - m;
}

struct Sampler {
  const Image& image;
  const Texture& texture;
  bool srgb;

  [[nodiscard]] glm::dvec4 texel(std::int64_t x, std::int64_t y) const {
    const auto column = static_cast<std::size_t>(wrapped(x, image.width, texture.wrap_s));
    const auto row = static_cast<std::size_t>(wrapped(y, image.height, texture.wrap_t));
    const std::uint8_t* at = &image.rgba[4 * (row * image.width + column)];
    glm::dvec4 value(at[0] / 255.0, at[1] / 255.0, at[2] / 255.0, at[3] / 255.0);
    if (srgb) value = {srgb_table()[at[0]], srgb_table()[at[1]], srgb_table()[at[2]], value.a};
    return value;
  }

  [[nodiscard]] glm::dvec4 at(const glm::dvec2& uv) const {
    // Beyond 1e9 texels there is no fraction left; the clamp keeps the conversion to integers defined.
    glm::dvec2 p = glm::clamp(uv * glm::dvec2(image.width, image.height), glm::dvec2(-1e9), glm::dvec2(1e9));
    if (texture.nearest) return texel(std::llround(std::floor(p.x)), std::llround(std::floor(p.y)));
    p -= 0.5;
    const glm::dvec2 base = glm::floor(p), f = p - base;
    const std::int64_t x = std::llround(base.x), y = std::llround(base.y);
    return glm::mix(glm::mix(texel(x, y), texel(x + 1, y), f.x), glm::mix(texel(x, y + 1), texel(x + 1, y + 1), f.x),
                    f.y);
  }
};

}  // namespace

glm::dvec4 look_up(const Scene& scene, const TextureUse& use, const glm::dvec2& uv0, const glm::dvec2& uv1, bool srgb) {
  if (!use.present()) return glm::dvec4(1);
  const Texture& texture = scene.textures[use.texture];
  if (texture.image == none || scene.images[texture.image].rgba.empty()) return glm::dvec4(1);
  // KHR_texture_transform: translation · rotation · scale; v points down, so counter-clockwise is (c, s; -s, c).
  const glm::dvec2 scaled = (use.uv_set == 1 ? uv1 : uv0) * glm::dvec2(use.scale);
  const double angle = use.rotation, c = std::cos(angle), s = std::sin(angle);
  const glm::dvec2 uv(c * scaled.x + s * scaled.y, -s * scaled.x + c * scaled.y);
  return Sampler{scene.images[texture.image], texture, srgb}.at(uv + glm::dvec2(use.offset));
}

}  // namespace sheaf::reference
