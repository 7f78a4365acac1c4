// SPDX-License-Identifier: MIT
#include "reference/surface.hpp"

#include <algorithm>
#include <cmath>

#include "reference/texture.hpp"

namespace sheaf::reference {
namespace {

glm::dvec3 unit(const glm::dvec3& v, const glm::dvec3& otherwise) {
  const double length = glm::length(v);
  return length > 0 && std::isfinite(length) ? v / length : otherwise;
}

/// The value at a point of the triangle, or `otherwise` where the mesh has none.
template <class Result, class Value>
Result interpolate(const std::vector<Value>& values, const glm::uvec3& v, const glm::dvec3& b,
                   const Result& otherwise) {
  if (values.empty()) return otherwise;
  return Result(values[v.x]) * b.x + Result(values[v.y]) * b.y + Result(values[v.z]) * b.z;
}

/// How far the triangle's highest corner is above the point, as the vertex normals see it; less than 1e-5 of its size
/// is flat.
double lift(const ReferenceTriangle& triangle, const Surface& s) {
  double most = 0, size = 0;
  for (const glm::dvec3& v : triangle.v) {
    const glm::dvec3 way = v - s.point;
    most = std::max(most, glm::dot(way, s.vertex_normal));
    size = std::max({size, std::abs(way.x), std::abs(way.y), std::abs(way.z)});
  }
  return most > 1e-5 * size && glm::dot(s.vertex_normal, s.geometric) > 0 ? most : 0;
}

constexpr double steepest = 1024;  // 1/cosine: surfaces seen flatter than that are not told apart

double sum_of(const glm::dvec3& v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); }

}  // namespace

struct Surfaces::Point {
  const ReferenceTriangle& triangle;
  const WorldInstance& instance;
  const Mesh& mesh;
  const Material& material;
  glm::uvec3 v;
  glm::dvec3 b;
  UvFootprint uv0, uv1;
  const Textures& textures;

  [[nodiscard]] static const std::vector<glm::vec2>& uvs(const WorldInstance& in, const Mesh& mesh, int set) {
    const auto& morphed = set == 0 ? in.uv0 : in.uv1;
    return !morphed.empty() ? morphed : set == 0 ? mesh.uv0 : mesh.uv1;
  }
  [[nodiscard]] glm::dvec4 look_up(const TextureUse& use, TexelKind kind = TexelKind::number) const {
    return filtered ? textures.mean(use, uv0, uv1, kind) : textures.at(use, uv0, uv1, kind);
  }
  bool filtered = false;
};

Surfaces::Point Surfaces::point(const Hit& hit) const {
  const ReferenceTriangle& t = world_.triangles[hit.triangle];
  const Mesh& mesh = scene_.meshes[t.mesh];
  const glm::uvec3 v = mesh.triangles[t.triangle_in_mesh];
  const WorldInstance& instance = world_.instances[t.instance];
  return {t,
          instance,
          mesh,
          scene_.materials[mesh.material],
          v,
          hit.barycentric,
          {interpolate(Point::uvs(instance, mesh, 0), v, hit.barycentric, glm::dvec2(0))},
          {interpolate(Point::uvs(instance, mesh, 1), v, hit.barycentric, glm::dvec2(0))},
          textures_};
}

std::uint32_t Surfaces::material_of(const Hit& hit) const {
  return scene_.meshes[world_.triangles[hit.triangle].mesh].material;
}

bool Surfaces::is_volume(std::uint32_t index) const {
  const Material& m = scene_.materials[index];
  return !opaque_ && !m.unlit && m.transmission > 0 && m.thickness > 0;
}

glm::dvec4 Surfaces::base_color(const Point& p) const {
  return glm::dvec4(p.material.base_color) * p.look_up(p.material.base_color_texture, textures_.base_kind(p.material)) *
         interpolate(p.instance.colors.empty() ? p.mesh.colors : p.instance.colors, p.v, p.b, glm::dvec4(1));
}

double Surfaces::coverage(const Point& p, double alpha) const {
  return !opaque_ && p.material.alpha_mode == AlphaMode::blend ? std::clamp(alpha, 0.0, 1.0) : 1.0;
}

double Surfaces::transmission(const Point& p) const {
  if (opaque_ || p.material.unlit) return 0;
  return std::clamp(p.material.transmission * p.look_up(p.material.transmission_texture).r, 0.0, 1.0);
}

bool Surfaces::exists(const Hit& hit) const {
  const Material& m = scene_.materials[material_of(hit)];
  return opaque_ || m.alpha_mode != AlphaMode::mask || base_color(point(hit)).a >= m.alpha_cutoff;
}

bool Surfaces::seen(Hit& hit, const Ray& ray) const {
  const Material& m = scene_.materials[material_of(hit)];
  const double cosine = glm::dot(front_normal(hit, -ray.direction), ray.direction);
  const bool two_sided = show_backs_ || m.double_sided || m.transmission > 0;
  if (!two_sided && !(cosine < 0)) return false;
  const SurfaceRank& place = world_.instances[world_.triangles[hit.triangle].instance].rank;
  const std::uint32_t rank = place.seen(cosine < 0);
  if (rank != 0)
    hit.order =
        hit.t + rank * step_across(sum_of(ray.origin) + std::abs(hit.t)) * std::min(1 / std::abs(cosine), steepest);
  return hit.order >= -ray.tmin && exists(hit);
}

double Surfaces::step_across(double reach) const { return 0x1p-19 * (reach + world_.rank_extent); }

Ray Surface::go_on(const glm::dvec3& direction, bool back) const {
  const double infinity = std::numeric_limits<double>::infinity();
  if (rank == 0) return {start(back ? geometric : -geometric), direction, 0, infinity};
  const double steep = std::min(1 / std::abs(glm::dot(geometric, direction)), steepest);
  return {point, direction, -((back ? rank_behind : rank) + 0.5) * step * steep, infinity};
}

glm::dvec3 Surfaces::front_normal(const Hit& hit, const glm::dvec3& otherwise) const {
  const ReferenceTriangle& t = world_.triangles[hit.triangle];
  return unit(glm::cross(t.v[1] - t.v[0], t.v[2] - t.v[0]), otherwise) *
         world_.instances[t.instance].side_of(scene_.meshes[t.mesh].triangles[t.triangle_in_mesh]);
}

glm::dvec3 Surfaces::vertex_normal(const Point& p, const glm::dvec3& geometric) const {
  return unit(interpolate(p.instance.normals, p.v, p.b, glm::dvec3(0)), geometric);
}

glm::dvec3 Surfaces::mapped_normal(const Point& p, const glm::dvec3& n) const {
  if (!p.material.normal_texture.present() || p.instance.tangents.empty()) return n;
  const glm::dvec3 t = unit(interpolate(p.instance.tangents, p.v, p.b, glm::dvec3(0)), glm::dvec3(0));
  const double handedness = p.mesh.tangents[p.v.x].w < 0 ? -1 : 1;  // the same at all three vertices
  const glm::dvec3 bitangent = glm::cross(n, t) * (handedness * p.instance.side_of(p.v));
  const glm::dvec3 texel = glm::dvec3(p.look_up(p.material.normal_texture)) * 2.0 - 1.0;
  const double strength = p.material.normal_texture.strength;
  return unit(t * (texel.x * strength) + bitangent * (texel.y * strength) + n * texel.z, n);
}

// Widens the point to the ellipse in which a cone of that width meets the surface (SHADING.md, Texture filter). Returns
// how much the interpolated normal turns towards a step along the surface, a unit of the step.
double Surfaces::spread_over(Point& p, const glm::dvec3& geometric, const glm::dvec3& direction, double width) const {
  const glm::dvec3 e1 = p.triangle.v[1] - p.triangle.v[0], e2 = p.triangle.v[2] - p.triangle.v[0],
                   n = glm::cross(e1, e2);
  const double area2 = glm::dot(n, n);
  if (!(area2 > 0)) return 0;
  const double cosine = glm::dot(geometric, direction);
  const glm::dvec3 level = direction - cosine * geometric;
  const glm::dvec3 any = std::abs(geometric.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 way = glm::normalize(glm::dot(level, level) > 1e-12 ? level : glm::cross(geometric, any));
  const glm::dvec3 across = glm::cross(geometric, way), along = way / std::max(std::abs(cosine), 1e-3);
  const auto step = [&](const glm::dvec3& a) {  // what it adds to the weights of the triangle's second and third vertex
    return glm::dvec2(glm::dot(glm::cross(a, e2), n), glm::dot(glm::cross(e1, a), n)) / area2;
  };
  const auto slope = [&](const auto& values, const glm::dvec3& a, const auto& zero) {
    using Value = std::decay_t<decltype(zero)>;
    if (values.empty()) return zero;
    const Value v0(values[p.v.x]), v1(values[p.v.y]), v2(values[p.v.z]);
    const glm::dvec2 s = step(a);
    return (v1 - v0) * s.x + (v2 - v0) * s.y;
  };
  const auto widen = [&](UvFootprint& f, const std::vector<glm::vec2>& uvs) {
    f.along = slope(uvs, along, glm::dvec2(0)) * width;
    f.across = slope(uvs, across, glm::dvec2(0)) * width;
  };
  widen(p.uv0, Point::uvs(p.instance, p.mesh, 0));
  widen(p.uv1, Point::uvs(p.instance, p.mesh, 1));
  p.filtered = true;
  const double size = glm::length(interpolate(p.instance.normals, p.v, p.b, glm::dvec3(0)));
  if (!(size > 0)) return 0;
  const auto turn = [&](const glm::dvec3& a) {
    return glm::dot(slope(p.instance.normals, a, glm::dvec3(0)), a) / glm::dot(a, a) / size;
  };
  return (turn(along) + turn(across)) / 2;
}

Surface Surfaces::at(const Hit& hit, const glm::dvec3& direction, double width) const {
  Point p = point(hit);
  const Material& m = p.material;
  Surface s;
  const glm::dvec3 parts[3] = {p.triangle.v[0] * p.b.x, p.triangle.v[1] * p.b.y, p.triangle.v[2] * p.b.z};
  s.point = parts[0] + parts[1] + parts[2];
  // The point is off its plane by a few ulps (1e-16) of the sums' terms, and so is the next test's view of the plane.
  const glm::dvec3 size = glm::abs(parts[0]) + glm::abs(parts[1]) + glm::abs(parts[2]);
  s.offset = 1e-12 * std::max({size.x, size.y, size.z});
  s.step = step_across(sum_of(s.point));
  const glm::dvec3 g = front_normal(hit, -direction);
  const double curvature = spread_over(p, g, direction, std::abs(width));
  const glm::dvec3 unmapped = vertex_normal(p, g), n = mapped_normal(p, unmapped);
  s.front = glm::dot(g, direction) < 0;
  s.geometric = s.front ? g : -g;
  s.rank = p.instance.rank.seen(s.front);
  s.rank_behind = p.instance.rank.turns ? p.instance.rank.seen(!s.front) : last_rank;
  if (s.rank != 0) s.offset = s.step;
  s.curvature = s.front ? curvature : -curvature;
  s.normal = s.front ? n : -n;
  s.vertex_normal = s.front ? unmapped : -unmapped;
  s.lift = lift(p.triangle, s);
  const glm::dvec4 base = base_color(p);
  s.base = base;
  s.alpha = coverage(p, base.a);
  const glm::dvec4 metallic_roughness = p.look_up(m.metallic_roughness_texture);
  s.metallic = std::clamp(m.metallic * metallic_roughness.b, 0.0, 1.0);
  s.roughness = std::clamp(m.roughness * metallic_roughness.g, 0.0, 1.0);
  s.emission = glm::dvec3(m.emissive) * glm::dvec3(p.look_up(m.emissive_texture, TexelKind::color));
  s.occlusion = 1 + m.occlusion_texture.strength * (p.look_up(m.occlusion_texture).r - 1);
  s.transmission = s.alpha < 1 ? 0 : transmission(p);
  s.material = p.mesh.material;
  s.volume = is_volume(s.material);
  s.unlit = m.unlit;
  s.ior = m.ior;
  s.uv = p.uv0.at;
  s.node = p.instance.node;
  return s;
}

glm::dvec3 Surfaces::transmittance(const Hit& hit, const glm::dvec3& direction) const {
  const Point p = point(hit);
  const glm::dvec4 base = base_color(p);
  if (!opaque_ && p.material.alpha_mode == AlphaMode::mask && base.a < p.material.alpha_cutoff) return glm::dvec3(1);
  glm::dvec3 passed(0);
  const double metal = p.material.metallic * p.look_up(p.material.metallic_roughness_texture).b;
  const double cosine = std::min(std::abs(glm::dot(front_normal(hit, -direction), direction)), 1.0);
  const double share = transmission(p) * (1 - std::clamp(metal, 0.0, 1.0));
  if (share > 0) passed = glm::dvec3(base) * (share * (1 - fresnel(cosine, 1, p.material.ior)));
  const double a = coverage(p, base.a);
  return glm::clamp((1 - a) + a * passed, 0.0, 1.0);
}

double fresnel(double cosine, double n1, double n2) {
  const double eta = n1 / n2, sine2 = eta * eta * std::max(0.0, 1 - cosine * cosine);
  if (sine2 >= 1) return 1;
  const double through = std::sqrt(1 - sine2);
  const double s = (n1 * cosine - n2 * through) / (n1 * cosine + n2 * through);
  const double p = (n2 * cosine - n1 * through) / (n2 * cosine + n1 * through);
  return (s * s + p * p) / 2;
}

glm::dvec3 schlick(const glm::dvec3& f0, double cosine) {
  return f0 + (1.0 - f0) * std::pow(std::clamp(1 - cosine, 0.0, 1.0), 5);
}

}  // namespace sheaf::reference
