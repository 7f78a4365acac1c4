// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "reference/reference.hpp"
#include "reference/surface.hpp"

namespace sheaf::reference {

struct WorldLight {
  LightKind kind;
  glm::dvec3 position;   // relative to the frame origin
  glm::dvec3 direction;  // the way the light travels; unit
  glm::dvec3 strength;   // candela or lux, by channel
  double range, spot_scale, spot_offset;
};

struct Arriving {                // at a point
  glm::dvec3 radiance, towards;  // `towards` the light
  double distance;               // infinite for a directional light
};

/// The scene's lights, or the documented default where it has none.
[[nodiscard]] std::vector<WorldLight> world_lights(const Scene& scene, const Pose& pose, const CameraView& view,
                                                   const glm::dvec3& origin);
[[nodiscard]] bool has_lights(const Scene& scene);

[[nodiscard]] Arriving arriving(const WorldLight& light, const glm::dvec3& point);

/// How a surface shares out what it gets (SHADING.md, 4 to 6).
struct Lobes {
  double r0;            // of the dielectric, straight on
  glm::dvec3 f0;        // of the mirroring lobe, straight on
  glm::dvec3 mirrored;  // Fs: all that is mirrored of the way seen
  double dielectric;    // Fd; the rest is left for the base, whether diffuse or let through
  double share;         // m': of `mirrored`, what the reflection ray brings
  double rise;          // s: how far the lobe's albedo rises at grazing angles
};

/// Of a surface seen at the cosine nv, as if it let nothing through.
[[nodiscard]] Lobes lobes_of(const Surface& s, double nv);

/// What surroundings of radiance 1 add without a ray, but for occlusion.
[[nodiscard]] glm::dvec3 ambient(const Surface& s, const Lobes& lobes);

/// The part of the light from `towards` that the surface sends to the viewer at v: f · (n·l).
[[nodiscard]] glm::dvec3 reflectance(const Surface& s, const Lobes& lobes, const glm::dvec3& v,
                                     const glm::dvec3& towards);

}  // namespace sheaf::reference
