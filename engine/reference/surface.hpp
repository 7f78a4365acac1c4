// SPDX-License-Identifier: MIT
// What a hit needs to know about the surface there (SHADING.md: Geometry, Material at a point).
#pragma once

#include "reference/texture.hpp"
#include "reference/tracer.hpp"
#include "reference/world.hpp"

namespace sheaf::reference {

struct Surface {
  glm::dvec3 point;              // relative to the frame origin
  double offset;                 // how far off the surface a new ray starts
  double step;                   // between ranks, along the normal
  glm::dvec3 geometric, normal;  // facing the ray
  glm::dvec3 vertex_normal;      // the same without a normal map
  double lift;  // along it, onto a level with the triangle's highest corner; 0 where the triangle is flat
  bool front;
  glm::dvec3 base;
  double alpha;  // coverage: 1 unless blended
  double metallic, roughness;
  glm::dvec3 emission;
  double occlusion, transmission;
  bool volume, unlit;
  double ior;
  glm::dvec2 uv;
  std::uint32_t rank, rank_behind;  // in its place, as the ray met it and as one meets it that comes back; 0: alone
  double curvature;                 // of the shading normal: > 0 where the surface bulges towards the ray
  std::uint32_t node, material;

  /// Where a ray goes on: beside the surface, or, where others lie in the same place, in that place, half a step behind
  /// the surface of that rank.
  [[nodiscard]] Ray go_on(const glm::dvec3& direction, bool back) const;

  /// A start on the side that `towards` points to.
  [[nodiscard]] glm::dvec3 start(const glm::dvec3& towards) const {
    return point + geometric * (glm::dot(geometric, towards) < 0 ? -offset : offset);
  }
  /// A shadow ray's start where the light is behind the triangle, but not behind the surface that its vertex normals
  /// make.
  [[nodiscard]] glm::dvec3 lifted_start() const { return point + vertex_normal * lift + geometric * offset; }
  [[nodiscard]] bool is_lifted_to(const glm::dvec3& light) const {
    return lift > 0 && glm::dot(geometric, light) <= 0 && glm::dot(vertex_normal, light) > 0;
  }
};

/// Reads the scene's surfaces; keeps references to both, which must outlive it.
class Surfaces {
 public:
  Surfaces(const Scene& scene, const World& world, bool opaque, bool show_backs)
      : scene_(scene), world_(world), textures_(scene, opaque), opaque_(opaque), show_backs_(show_backs || opaque) {}

  /// `width`: of the ray's cone at the hit; textures are means over what it covers.
  [[nodiscard]] Surface at(const Hit& hit, const glm::dvec3& direction, double width) const;

  /// False for a point that an alpha mask cuts out.
  [[nodiscard]] bool exists(const Hit& hit) const;

  /// Whether a ray that is not a shadow ray is stopped there: the point exists, and is not a back that is hidden.
  /// `hit` learns its order along the ray.
  [[nodiscard]] bool seen(Hit& hit, const Ray& ray) const;

  /// The light that passes straight through, as shadow rays see it.
  [[nodiscard]] glm::dvec3 transmittance(const Hit& hit, const glm::dvec3& direction) const;

  /// Unit, not turned towards anything: the front's.
  [[nodiscard]] glm::dvec3 front_normal(const Hit& hit, const glm::dvec3& otherwise) const;

  [[nodiscard]] const Material& material(std::uint32_t index) const { return scene_.materials[index]; }
  [[nodiscard]] std::uint32_t material_of(const Hit& hit) const;
  [[nodiscard]] bool is_volume(std::uint32_t material) const;

 private:
  struct Point;
  /// Between ranks, along the normal, of hits at most so far from the origin (the sum of coordinates).
  [[nodiscard]] double step_across(double reach) const;
  [[nodiscard]] Point point(const Hit& hit) const;
  [[nodiscard]] double spread_over(Point& p, const glm::dvec3& geometric, const glm::dvec3& direction,
                                   double width) const;
  [[nodiscard]] glm::dvec4 base_color(const Point& p) const;
  [[nodiscard]] double coverage(const Point& p, double alpha) const;
  [[nodiscard]] double transmission(const Point& p) const;
  [[nodiscard]] glm::dvec3 vertex_normal(const Point& p, const glm::dvec3& geometric) const;
  [[nodiscard]] glm::dvec3 mapped_normal(const Point& p, const glm::dvec3& n) const;

  const Scene& scene_;
  const World& world_;
  Textures textures_;
  bool opaque_, show_backs_;
};

/// Unpolarised reflectance of a smooth interface from index n1 to n2; 1 in total internal reflection.
[[nodiscard]] double fresnel(double cosine, double n1, double n2);
[[nodiscard]] glm::dvec3 schlick(const glm::dvec3& f0, double cosine);

}  // namespace sheaf::reference
