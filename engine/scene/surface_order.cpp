// SPDX-License-Identifier: MIT
#include "scene/surface_order.hpp"

#include <algorithm>
#include <cstring>

namespace sheaf {
namespace {

class Hash {  // FNV-1a over 64-bit words
 public:
  void add(std::uint64_t word) { value_ = (value_ ^ word) * 0x100000001B3U; }
  void add(double number) {
    std::uint64_t word = 0;
    number += 0.0;  // -0 is 0
    std::memcpy(&word, &number, sizeof(word));
    add(word);
  }
  [[nodiscard]] std::uint64_t value() const { return value_ ^ (value_ >> 32U); }
  [[nodiscard]] double number() const { return static_cast<double>(value() >> 11U); }

 private:
  std::uint64_t value_ = 0xCBF29CE484222325U;
};

void add_factor(std::vector<double>& to, float value) { to.push_back(value); }

template <int N>
void add_factor(std::vector<double>& to, const glm::vec<N, float>& value) {
  for (int c = 0; c < N; ++c) to.push_back(value[c]);
}

void add_texture(std::vector<double>& to, const Scene& scene, const TextureUse& use) {
  to.push_back(use.present() ? 1 : 0);
  if (!use.present()) return;
  const Texture& texture = scene.textures[use.texture];
  to.insert(to.end(), {static_cast<double>(use.uv_set), use.offset.x, use.offset.y, use.scale.x, use.scale.y,
                       use.rotation, use.strength, static_cast<double>(texture.wrap_s),
                       static_cast<double>(texture.wrap_t), texture.nearest ? 1.0 : 0.0});
  if (texture.image == none) return;
  const Image& image = scene.images[texture.image];
  Hash pixels;
  for (const std::uint8_t byte : image.rgba) pixels.add(std::uint64_t{byte});
  to.insert(to.end(), {static_cast<double>(image.width), static_cast<double>(image.height), pixels.number()});
}

// A sum over distinct vertices: neither their order nor how often the file repeats one counts.
double shape_of(const Mesh& mesh) {
  std::vector<std::uint64_t> vertices;
  vertices.reserve(mesh.triangles.size() * 3);
  for (const auto& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t v = t[k];
      Hash hash;
      for (int c = 0; c < 3; ++c) hash.add(double{mesh.positions[v][c]} + mesh.centre[c]);
      for (const auto* uvs : {&mesh.uv0, &mesh.uv1})
        if (!uvs->empty()) hash.add(double{(*uvs)[v].x}), hash.add(double{(*uvs)[v].y});
      for (int c = 0; c < 4 && !mesh.colors.empty(); ++c) hash.add(double{mesh.colors[v][c]});
      vertices.push_back(hash.value());
    }
  }
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  Hash all;
  for (const auto vertex : vertices) all.add(vertex);
  return all.number();
}

}  // namespace

SurfaceKind kind_of(const Material& m, const SurfaceView& view) {
  if (view.opaque) return SurfaceKind::opaque;
  const bool through = m.transmission > 0 && !m.unlit;
  if (through && m.thickness > 0) return SurfaceKind::volume;
  if (m.alpha_mode == AlphaMode::blend) return SurfaceKind::blended;
  if (m.alpha_mode == AlphaMode::mask) return SurfaceKind::masked;
  return through ? SurfaceKind::thin : SurfaceKind::opaque;
}

std::vector<double> content_of(const Scene& scene, const Material& m, const Mesh& mesh, const glm::dmat4& world,
                               const SurfaceView& view) {
  std::vector<double> content{static_cast<double>(kind_of(m, view))};
  for (int c = 0; c < 4; ++c)
    content.push_back(-double{m.base_color[c]});  // the brighter in red, then green, then blue
  for (int c = 0; c < 3; ++c) content.push_back(-double{m.emissive[c]});
  content.push_back(m.unlit ? 1 : 0);
#define SHEAF_FACTOR(type, words, field, value, owner, key, low, high) add_factor(content, m.field);
  MATERIAL_FACTORS(SHEAF_FACTOR)
#undef SHEAF_FACTOR
  content.insert(content.end(), {m.thickness, m.double_sided ? 1.0 : 0.0, m.attenuation_color.x, m.attenuation_color.y,
                                 m.attenuation_color.z, m.attenuation_distance});
  for_each_texture(m, [&](const TextureUse& use, auto...) { add_texture(content, scene, use); });
  content.push_back(shape_of(mesh));
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 3; ++r) content.push_back(world[c][r]);
  return content;
}

}  // namespace sheaf
