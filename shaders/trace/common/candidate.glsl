// SPDX-License-Identifier: MIT
// What becomes of a triangle that a ray was found to cross: the nearest counts (ties: the lower triangle), or, for
// shadow rays, light passes or does not. Every strategy's intersect goes through here.
#ifndef SHEAF_CANDIDATE_GLSL
#define SHEAF_CANDIDATE_GLSL
#include "lib/common.glsl"
#include "lib/frame.glsl"
#include "scene/memory.glsl"
#include "scene/scene.glsl"
#include "scene/triangle.glsl"
#include "interface/shading.h"
#include "interface/scene.h"
#include "scene/attributes.glsl"
#include "scene/fresnel.glsl"
#include "lib/unit.glsl"

// MASKED: some material has an alpha mask. TRANSLUCENT: some surface lets light through, shadow rays sum optical depth.
layout(constant_id = SPEC_MASKED) const bool MASKED = true;
layout(constant_id = SPEC_TRANSLUCENT) const bool TRANSLUCENT = true;
// For shadow rays, whose any hit will do.
layout(constant_id = SPEC_ANY_HIT) const bool ANY_HIT = false;

// Whether a hit may have to ask its material before it counts.
bool asks_materials() { return ANY_HIT ? TRANSLUCENT : MASKED; }

struct Nearest {
  float t;
  uint triangle;
};

// A candidate that its material may yet take back. Looking at materials is rare and costs much, and on a SIMD device
// code that one lane needs is paid by all: so traversal goes on until no lane can without an answer, and asks for all
// lanes at once.
struct Pending {
  uint triangle;  // NO_INDEX: none
  float t;
  vec3 barycentric;
};
const Pending NOTHING_PENDING = Pending(NO_INDEX, 0.0, vec3(0));

// A nearer hit, or an equal one of a lower triangle, is taken; where an alpha mask has a say it is left pending.
void consider_nearest_corners(Corners corners, uint triangle, Shear s, float tmin, inout Nearest best,
                              inout Pending pending) {
  TriangleHit h = seen_corners(s, corners, tmin, best.t);
  if (!h.hit || (h.t == best.t && triangle > best.triangle)) return;
  if (MASKED && (corners.instance & TRIANGLE_MASKED) != 0u) {
    pending = Pending(triangle, h.t, h.barycentric);
    return;
  }
  best.t = h.t;
  best.triangle = triangle;
}

void consider_nearest(uint triangle, Shear s, float tmin, inout Nearest best, inout Pending pending) {
  consider_nearest_corners(load_triangle(triangle), triangle, s, tmin, best, pending);
}

void settle_nearest(inout Nearest best, inout Pending pending) {
  if (pending.triangle != NO_INDEX && !masked_out(pending.triangle, pending.barycentric)) {
    best.t = pending.t;
    best.triangle = pending.triangle;
  }
  pending.triangle = NO_INDEX;
}

struct Shade {      // what a shadow ray has met so far
  bool blocked;
  uint triangle;    // the lowest that blocks; any would do
  float t;
  ivec3 optical_depth;      // −log2 of the light passed, OPTICAL_STEP steps a stop
};

const float LEAST_LIGHT = 2.4e-10;  // 2^-32: less is nothing
const float MAX_OPTICAL_DEPTH = 65536.0;    // of one crossing: eight of them fit a 32-bit sum
// Of a crossing of a black volume: thousands fit, and each is more than LEAST_LIGHT.
const float BLACK_OPTICAL_DEPTH = 128.0;

ivec3 to_steps(vec3 depth) {
  return ivec3(round(clamp(depth, -MAX_OPTICAL_DEPTH, MAX_OPTICAL_DEPTH) * float(OPTICAL_STEP)));
}

// Optical depth of one crossing at t; false where nothing passes. A finite tmax: the ray comes from the light and ends
// at the lit point, so a volume entered at t and not left absorbs over tmax − t; else it comes from the point, and one
// left absorbs over t.
bool crossing(uint triangle, vec3 b, vec3 direction, float t, float tmax, inout ivec3 depth) {
  Corners corners = load_triangle(triangle);
  ShadingInputs looks = shading_inputs_of(instance_of(corners));
  Instance instance = looks.instance;
  Material m = looks.material;
  if ((m.flags & MATERIAL_NOT_OPAQUE) == 0u) return false;
  uvec3 v = triangle_vertices(instance, triangle);
  vec2 uv0 = interpolate_uv(instance.uv0, v, b), uv1 = interpolate_uv(instance.uv1, v, b);
  vec4 texels[TEXTURES];
  look_up_all(instance.material, TEXTURE_TRANSMISSION + 1u, uv0, uv1, texels);
  vec4 base = base_color_at(instance, m, v, b, texels[TEXTURE_BASE_COLOR]);
  if ((m.flags & MATERIAL_MASK) != 0u && base.a < m.alpha_cutoff) return true;
  float cosine = dot(triangle_normal(corners.a, corners.b, corners.c, vec3(0)), direction) * front_sign(corners);
  vec3 passed = vec3(0);
  if ((m.flags & MATERIAL_TRANSMISSIVE) != 0u) {
    float transmitted = clamp(m.transmission * texels[TEXTURE_TRANSMISSION].r, 0.0, 1.0);
    float metal = clamp(m.metallic * texels[TEXTURE_METALLIC_ROUGHNESS].b, 0.0, 1.0);
    passed = (transmitted * (1.0 - metal) * (1.0 - fresnel(min(abs(cosine), 1.0), 1.0, m.ior))) * base.rgb;
  }
  float a = (m.flags & MATERIAL_BLEND) != 0u ? clamp(base.a, 0.0, 1.0) : 1.0;
  passed = (1.0 - a) + a * passed;
  if (!(max(max(passed.x, passed.y), passed.z) > LEAST_LIGHT)) return false;
  depth += to_steps(-log2(clamp(passed, vec3(LEAST_LIGHT), vec3(1))));
  if (m.volume != 0u) {
    // What is more than MAX_OPTICAL_DEPTH over the whole way (that of a ray without an end: across the scene, whose
    // largest coordinate is box_pad · 2^21) is that much, so that what entering adds and leaving takes away keep their
    // difference.
    float inside = tmax < INFINITY ? tmax - t : -t, way = tmax < INFINITY ? tmax : frame.box_pad * 8388608.0;
    vec3 absorption = min(m.absorption, vec3(MAX_OPTICAL_DEPTH / max(way, 1e-30)));
    vec3 more = absorption * (cosine < 0.0 ? inside : -inside);
    for (uint c = 0u; c < 3u; ++c) more[c] = m.absorption[c] >= ABSORBS_ALL ? BLACK_OPTICAL_DEPTH : more[c];
    depth += to_steps(more);
  }
  return true;
}

void consider_shadow_corners(Corners corners, uint triangle, Shear s, float tmin, float tmax, inout Shade shade,
                             inout Pending pending) {
  TriangleHit h = intersect_corners(s, corners, tmin, tmax);
  if (!h.hit) return;
  if (TRANSLUCENT && (corners.instance & (TRIANGLE_MASKED | TRIANGLE_TRANSLUCENT)) != 0u) {
    pending = Pending(triangle, h.t, h.barycentric);
    return;
  }
  shade.blocked = true;
  shade.triangle = triangle;
  shade.t = h.t;
}

void consider_shadow(uint triangle, Shear s, float tmin, float tmax, inout Shade shade, inout Pending pending) {
  consider_shadow_corners(load_triangle(triangle), triangle, s, tmin, tmax, shade, pending);
}

void settle_shadow(vec3 direction, float tmax, inout Shade shade, inout Pending pending) {
  if (pending.triangle != NO_INDEX &&
      !crossing(pending.triangle, pending.barycentric, direction, pending.t, tmax, shade.optical_depth)) {
    shade.blocked = true;
    shade.triangle = pending.triangle;
    shade.t = pending.t;
  }
  pending.triangle = NO_INDEX;
}
#endif
