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

glm::dvec4 decoded(const std::uint8_t* at, TexelKind kind) {
  const double alpha = at[3] / 255.0;
  if (kind == TexelKind::number) return {at[0] / 255.0, at[1] / 255.0, at[2] / 255.0, alpha};
  return {srgb_table()[at[0]], srgb_table()[at[1]], srgb_table()[at[2]], alpha};
}

// KHR_texture_transform: translation · rotation · scale; v points down, so counter-clockwise is (c, s; -s, c).
UvFootprint transformed(const TextureUse& use, const UvFootprint& f) {
  const double angle = use.rotation, c = std::cos(angle), s = std::sin(angle);
  const auto turned = [&](glm::dvec2 v) {
    v *= glm::dvec2(use.scale);
    return glm::dvec2(c * v.x + s * v.y, -s * v.x + c * v.y);
  };
  return {turned(f.at) + glm::dvec2(use.offset), turned(f.along), turned(f.across)};
}

}  // namespace

Textures::Textures(const Scene& scene, bool opaque) : scene_(scene), opaque_(opaque) {
  for (const Material& m : scene.materials) {
    for_each_texture(m, [&](const TextureUse& use, auto, std::uint32_t content) {
      const bool base = &use == &m.base_color_texture;
      prepare(use, base ? base_kind(m) : content == CONTENT_COLOR ? TexelKind::color : TexelKind::number);
    });
  }
}

TexelKind Textures::base_kind(const Material& material) const {
  return material.alpha_mode != AlphaMode::opaque && !opaque_ ? TexelKind::color_by_alpha : TexelKind::color;
}

const Image* Textures::image_of(const TextureUse& use) const {
  if (!use.present()) return nullptr;
  const std::uint32_t image = scene_.textures[use.texture].image;
  return image == none || scene_.images[image].rgba.empty() ? nullptr : &scene_.images[image];
}

// A texel of a level is the mean of the part of the level before that it covers; colours weighted by alpha where alpha
// counts.
void Textures::prepare(const TextureUse& use, TexelKind kind) {
  const Image* image = image_of(use);
  if (image == nullptr || !scene_.textures[use.texture].mipmapped) return;
  Levels& levels = levels_[{scene_.textures[use.texture].image, kind}];
  if (!levels.empty()) return;
  levels.push_back({image->width, image->height, {}});
  while (levels.back().width > 1 || levels.back().height > 1) {
    const Level& from = levels.back();
    Level to{std::max<std::int64_t>(from.width / 2, 1), std::max<std::int64_t>(from.height / 2, 1), {}};
    const double across = static_cast<double>(from.width) / static_cast<double>(to.width);
    const double down = static_cast<double>(from.height) / static_cast<double>(to.height);
    const auto part = [](std::int64_t i, double begin, double end) {
      return std::min(end, static_cast<double>(i + 1)) - std::max(begin, static_cast<double>(i));
    };
    for (std::int64_t y = 0; y < to.height; ++y)
      for (std::int64_t x = 0; x < to.width; ++x) {
        const double left = static_cast<double>(x) * across, top = static_cast<double>(y) * down;
        glm::dvec4 sum(0);
        double all = 0, alpha = 0;
        for (auto v = static_cast<std::int64_t>(top); v < from.height && static_cast<double>(v) < top + down; ++v)
          for (auto u = static_cast<std::int64_t>(left); u < from.width && static_cast<double>(u) < left + across;
               ++u) {
            const double area = part(u, left, left + across) * part(v, top, top + down);
            const glm::dvec4 value =
                from.values.empty() ? decoded(&image->rgba[static_cast<std::size_t>(4 * (v * from.width + u))], kind)
                                    : glm::dvec4(from.values[static_cast<std::size_t>(v * from.width + u)]);
            const double weight = kind == TexelKind::color_by_alpha ? area * value.a : area;
            sum += glm::dvec4(glm::dvec3(value) * weight, value.a * area);
            all += area;
            alpha += weight;
          }
        to.values.emplace_back(alpha > 0 ? glm::dvec3(sum) / alpha : glm::dvec3(0), sum.a / all);
      }
    levels.push_back(std::move(to));
  }
}

glm::dvec4 Textures::texel(const Image& image, const Level& level, std::int64_t x, std::int64_t y,
                           const Texture& texture, TexelKind kind) const {
  const auto at = static_cast<std::size_t>(wrapped(y, level.height, texture.wrap_t) * level.width +
                                           wrapped(x, level.width, texture.wrap_s));
  return level.values.empty() ? decoded(&image.rgba[4 * at], kind) : glm::dvec4(level.values[at]);
}

glm::dvec4 Textures::filtered(const Image& image, const Level& level, const Texture& texture, const glm::dvec2& uv,
                              TexelKind kind, bool nearest) const {
  // As on the device: beyond it single precision has no fraction left.
  glm::dvec2 p = glm::clamp(uv * glm::dvec2(level.width, level.height), glm::dvec2(-8388000.0), glm::dvec2(8388000.0));
  const auto read = [&](std::int64_t x, std::int64_t y) { return texel(image, level, x, y, texture, kind); };
  if (nearest) return read(std::llround(std::floor(p.x)), std::llround(std::floor(p.y)));
  p -= 0.5;
  const glm::dvec2 base = glm::floor(p), f = p - base;
  const std::int64_t x = std::llround(base.x), y = std::llround(base.y);
  return glm::mix(glm::mix(read(x, y), read(x + 1, y), f.x), glm::mix(read(x, y + 1), read(x + 1, y + 1), f.x), f.y);
}

glm::dvec4 Textures::at(const TextureUse& use, const UvFootprint& uv0, const UvFootprint& uv1, TexelKind kind) const {
  const Image* image = image_of(use);
  if (image == nullptr) return glm::dvec4(1);
  const Texture& texture = scene_.textures[use.texture];
  const UvFootprint f = transformed(use, use.uv_set == 1 ? uv1 : uv0);
  return filtered(*image, {image->width, image->height, {}}, texture, f.at, kind, texture.nearest);
}

glm::dvec4 Textures::mean(const TextureUse& use, const UvFootprint& uv0, const UvFootprint& uv1, TexelKind kind) const {
  const Image* image = image_of(use);
  if (image == nullptr) return glm::dvec4(1);
  const Texture& texture = scene_.textures[use.texture];
  if (!texture.mipmapped) return at(use, uv0, uv1, kind);
  const Levels& levels = levels_.at({texture.image, kind});
  const UvFootprint f = transformed(use, use.uv_set == 1 ? uv1 : uv0);
  const glm::dvec2 size(image->width, image->height);
  const double along = glm::length(f.along * size), across = glm::length(f.across * size);
  const glm::dvec2 axis = along >= across ? f.along : f.across;
  const double major = std::min(std::max(along, across), 1e9), minor = std::max(std::min(along, across), 1e-9);
  const double taps = std::clamp(std::ceil(std::min(major / minor, major)), 1.0, 8.0);
  const double lod = std::clamp(std::log2(std::max(major / taps, 1.0)), 0.0, static_cast<double>(levels.size() - 1));
  const auto level = static_cast<std::size_t>(lod);
  const double upper = lod - static_cast<double>(level);
  glm::dvec4 sum(0);
  for (double k = 0; k < taps; ++k) {
    const glm::dvec2 uv = f.at + axis * ((k + 0.5) / taps - 0.5);
    const bool nearest = texture.nearest && lod == 0;
    sum += (1 - upper) * filtered(*image, levels[level], texture, uv, kind, nearest);
    if (upper > 0) sum += upper * filtered(*image, levels[level + 1], texture, uv, kind, false);
  }
  return sum / taps;
}

}  // namespace sheaf::reference
