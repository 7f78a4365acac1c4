// SPDX-License-Identifier: MIT
#include "scene/spec_gloss.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace sheaf {
namespace {

constexpr double dielectric = 0.04;  // F0 of a metallic-roughness material that is no metal

double brightness(const glm::dvec3& c) { return std::sqrt(glm::dot(glm::dvec3(0.299, 0.587, 0.114), c * c)); }

// Diffuse light D and reflectance S of a metallic-roughness material are
//   D = (1 - f)·base·(1 - m),   S = f·(1 - m) + base·m,   f = dielectric.
// Without base: f·m² + (D / (1 - f) + S - 2f)·m + f - S = 0, whose larger root lies between 0 and 1 for S >= f.
double metallic_of(double diffuse, double specular) {
  if (specular <= dielectric) return 0;
  const double b = diffuse / (1 - dielectric) + specular - 2 * dielectric, c = dielectric - specular;
  const double root = std::sqrt(std::max(b * b - 4 * dielectric * c, 0.0));
  return std::clamp((root - b) / (2 * dielectric), 0.0, 1.0);
}

double linear(double v) { return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4); }

double from_srgb(std::uint8_t value) {
  static const std::array<double, 256> table = [] {
    std::array<double, 256> out{};
    for (std::size_t i = 0; i < 256; ++i) out[i] = linear(static_cast<double>(i) / 255);
    return out;
  }();
  return table[value];
}

std::uint8_t to_byte(double value) { return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 1.0) * 255)); }

// The nearest, by the values half way between two: a search costs less than a power.
std::uint8_t to_srgb(double value) {
  static const std::array<double, 255> limits = [] {
    std::array<double, 255> out{};
    for (std::size_t i = 0; i < 255; ++i) out[i] = linear((static_cast<double>(i) + 0.5) / 255);
    return out;
  }();
  return static_cast<std::uint8_t>(std::ranges::upper_bound(limits, value) - limits.begin());
}

// The texel of `image` at the centre of texel (x, y) of an image of `width` by `height`; rgb is sRGB, alpha is not.
glm::dvec4 texel(const Image* image, std::uint32_t x, std::uint32_t y, std::uint32_t width, std::uint32_t height) {
  if (image == nullptr) return glm::dvec4(1);
  const std::uint64_t u = (2 * std::uint64_t{x} + 1) * image->width / (2 * std::uint64_t{width});
  const std::uint64_t v = (2 * std::uint64_t{y} + 1) * image->height / (2 * std::uint64_t{height});
  const std::uint8_t* const t = &image->rgba[(v * image->width + u) * 4];
  return {from_srgb(t[0]), from_srgb(t[1]), from_srgb(t[2]), t[3] / 255.0};
}

Image blank(const Image* diffuse, const Image* specular_glossiness) {
  Image image;
  for (const Image* of : {diffuse, specular_glossiness}) {
    if (of == nullptr) continue;
    if (image.name.empty()) image.name = of->name;
    image.width = std::max(image.width, of->width);
    image.height = std::max(image.height, of->height);
  }
  image.rgba.resize(std::size_t{image.width} * image.height * 4);
  return image;
}

}  // namespace

MetalRough to_metal_rough(const SpecGloss& surface) {
  const glm::dvec3 specular(surface.specular);
  const double rest = 1 - std::max({specular.r, specular.g, specular.b});
  const glm::dvec3 diffuse = glm::dvec3(surface.diffuse) * rest;
  const double m = metallic_of(brightness(diffuse), brightness(specular));
  // The colour of a dielectric is told by what it scatters, that of a metal by what it mirrors.
  constexpr double least = 1e-6;
  const glm::dvec3 scattered = diffuse / (1 - dielectric) / std::max(1 - m, least);
  const glm::dvec3 mirrored = (specular - dielectric * (1 - m)) / std::max(m, least);
  const glm::dvec3 base = glm::clamp(glm::mix(scattered, mirrored, m * m), 0.0, 1.0);
  return {glm::vec4(glm::vec3(base), surface.diffuse.a), static_cast<float>(m), 1 - surface.glossiness};
}

MetalRoughImages to_metal_rough(const SpecGloss& factors, const Image* diffuse, const Image* specular_glossiness) {
  MetalRoughImages out{blank(diffuse, specular_glossiness), blank(diffuse, specular_glossiness)};
  const std::uint32_t width = out.base_color.width, height = out.base_color.height;
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      const glm::dvec4 scattered = texel(diffuse, x, y, width, height);
      const glm::dvec4 mirrored = texel(specular_glossiness, x, y, width, height);
      const MetalRough surface =
          to_metal_rough({factors.diffuse * glm::vec4(scattered), factors.specular * glm::vec3(mirrored),
                          factors.glossiness * static_cast<float>(mirrored.a)});
      const std::size_t at = (std::size_t{y} * width + x) * 4;
      std::uint8_t* const base = &out.base_color.rgba[at];
      for (int c = 0; c < 3; ++c) base[c] = to_srgb(surface.base_color[c]);
      base[3] = to_byte(surface.base_color.a);
      std::uint8_t* const rough = &out.metallic_roughness.rgba[at];
      rough[1] = to_byte(surface.roughness);
      rough[2] = to_byte(surface.metallic);
      rough[3] = 255;
    }
  }
  return out;
}

}  // namespace sheaf
