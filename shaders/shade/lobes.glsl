// SPDX-License-Identifier: MIT
// How a surface shares out what it gets (SHADING.md, 4 to 6): what it mirrors, what is left for its base, and its light
// of lamps.
#ifndef SHEAF_LOBES_GLSL
#define SHEAF_LOBES_GLSL
#include "lib/unit.glsl"
#include "scene/fresnel.glsl"
#include "shade/surface.glsl"
struct Lobes {
  vec3 f0;           // of the mirroring lobe, straight on
  // Fs: all that is mirrored of the way seen, whether by the reflection ray or from the surroundings at large.
  vec3 mirrored;
  // Fd: that of the part that is no metal; the rest is left for the base, whether diffuse or let through.
  float dielectric;
  float share;       // m': of `mirrored`, what the reflection ray brings
  float rise;        // s: how far the lobe's albedo rises at grazing angles
  float kept;        // (1 - E(n·v)) / (1 - mean of E), for lamps
};

float fifth(float x) {
  float m = clamp(1.0 - x, 0.0, 1.0), m2 = m * m;
  return m2 * m2 * m;
}

Lobes lobes_of(Surface s, float ior, float nv) {
  Lobes lobes;
  float r = (ior - 1.0) / (ior + 1.0), r0 = r * r, q = max(1.0 - s.roughness / 0.4, 0.0), rough = max(s.roughness, 0.1);
  lobes.f0 = mix(vec3(r0), s.base.rgb, s.metallic);
  lobes.mirrored = schlick(lobes.f0, nv);
  lobes.dielectric = r0 + (1.0 - r0) * fifth(nv);
  lobes.share = q * q;
  float narrows = 1.0 - 0.6 * (rough * rough - 0.01);
  lobes.rise = narrows * narrows * narrows;
  lobes.kept = (1.0 - r0) * (1.0 - lobes.rise * fifth(nv)) / (1.0 - lobes.rise / 21.0);
  return lobes;
}

// What surroundings of radiance 1 add without a ray.
vec3 ambient_of(Surface s, Lobes lobes) {
  float diffuse = (1.0 - s.metallic) * (1.0 - s.transmission) * (1.0 - lobes.dielectric);
  return diffuse * s.base.rgb + (1.0 - lobes.share) * lobes.mirrored;
}

vec3 reflectance(Surface s, Lobes lobes, vec3 v, vec3 l) {  // f · (n·l)
  float nl = dot(s.normal, l);
  float nv = clamp(dot(s.normal, v), 1e-4, 1.0);
  vec3 h = safe_normalize(v + l, s.normal);
  float nh = clamp(dot(s.normal, h), 0.0, 1.0);
  vec3 f = schlick(lobes.f0, clamp(dot(v, h), 0.0, 1.0));
  float rough = max(s.roughness, 0.1);
  float a2 = rough * rough * rough * rough;
  float q = nh * nh * (a2 - 1.0) + 1.0;
  float d = a2 / (3.14159265 * q * q);
  float visibility = 0.5 / (nl * sqrt(nv * nv * (1.0 - a2) + a2) + nv * sqrt(nl * nl * (1.0 - a2) + a2));
  vec3 left = min(1.0 - f, vec3(lobes.kept * (1.0 - lobes.rise * fifth(nl))));
  vec3 diffuse = left * ((1.0 - s.metallic) * (1.0 - s.transmission) / 3.14159265) * s.base.rgb;
  return (diffuse + f * (d * visibility)) * nl;
}

// Where a surface lets light through: what of it is mirrored follows from the media on both sides (7).
struct Interface {
  vec3 normal;   // that bends rays: it faces them
  float cosine;
  float n1, n2;
  uint medium;   // stack beyond
};
#endif
