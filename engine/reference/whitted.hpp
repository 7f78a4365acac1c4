// SPDX-License-Identifier: MIT
// The light that comes along one camera ray, with all the rays that follow from it (Whitted 1980; SHADING.md).
#pragma once

#include "reference/light.hpp"
#include "reference/surface.hpp"
#include "reference/tracer.hpp"

namespace sheaf::reference {

/// The volumes a ray is inside, outermost first; at most four, the outermost falls out.
class Media {
 public:
  void push(std::uint32_t material);
  void remove(std::uint32_t material);  // its topmost entry, if any
  [[nodiscard]] std::uint32_t top() const { return count_ == 0 ? none : entries_[count_ - 1]; }

 private:
  std::array<std::uint32_t, 4> entries_{};
  std::uint32_t count_ = 0;
};

struct Radiance {
  glm::dvec3 color{0};
  double alpha = 0;
  Hit first;  // of the camera's ray
};

class Whitted {
 public:
  Whitted(const Tracer& tracer, const Surfaces& surfaces, std::vector<WorldLight> lights, glm::dvec3 environment,
          const ReferenceSettings& settings)
      : tracer_(tracer),
        surfaces_(surfaces),
        lights_(std::move(lights)),
        environment_(environment),
        settings_(settings) {}

  /// `width`, `spread`: of the camera ray's cone, at its origin and a unit of t further.
  [[nodiscard]] Radiance trace(const Ray& camera, double width, double spread, ReferenceCounts& counts) const;

 private:
  struct Pending {
    Ray ray;
    glm::dvec3 weight{1};
    double coverage = 0;
    std::uint32_t bounces = 0, blended = 0, kind = 0;  // blended: surfaces gone straight through
    Media media;
    double width = 0, spread = 0;  // of the ray's cone: at its origin, and what a unit of t adds
  };
  struct Work {
    Radiance sum;
    std::vector<Pending> rays;
    ReferenceCounts& counts;
  };

  void shade(const Pending& ray, const Hit& hit, Work& work) const;
  struct Interface {  // of a surface that lets light through
    glm::dvec3 normal;
    double n1, n2;
    Media beyond;
  };

  void light(const Surface& s, const glm::dvec3& weight, const Lobes& lobes, const glm::dvec3& v, Work& work) const;
  [[nodiscard]] Interface see_through(const Surface& s, double nv, const Pending& parent, Lobes& lobes) const;
  double transmit(const Surface& s, const glm::dvec3& weight, const Lobes& lobes, const Interface& face,
                  const Pending& parent, Work& work) const;
  void reflect(const Surface& s, const glm::dvec3& weight, const Pending& parent, Work& work) const;
  bool go_on(const Surface& s, const glm::dvec3& direction, const Pending& child, Work& work) const;
  void go_straight(const Surface& s, const Pending& child, Work& work) const;
  [[nodiscard]] bool worth_a_ray(const Pending& ray) const;
  [[nodiscard]] glm::dvec3 absorbed(const Pending& ray, const Surface& s, double t) const;
  [[nodiscard]] glm::dvec3 visibility(const Surface& s, const WorldLight& light, const Arriving& in,
                                      ReferenceCounts& counts) const;
  [[nodiscard]] double ior(std::uint32_t material) const;

  const Tracer& tracer_;
  const Surfaces& surfaces_;
  std::vector<WorldLight> lights_;
  glm::dvec3 environment_;
  ReferenceSettings settings_;
};

}  // namespace sheaf::reference
