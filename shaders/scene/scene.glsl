// SPDX-License-Identifier: MIT
// Reading triangles.
#ifndef SHEAF_SCENE_GLSL
#define SHEAF_SCENE_GLSL
#include "lib/frame.glsl"
#include "scene/memory.glsl"
#include "scene/triangle.glsl"
#include "scene/ranks.glsl"

// The sign that turns (b − a) × (c − a) to the front: of the instance's matrix, or of the triangle's own skinning
// matrices.
float front_sign(Corners corners) {
  return uintBitsToFloat(0x3F800000u | ((corners.instance & TRIANGLE_MIRRORED) << 3));
}

uint instance_of(Corners corners) { return corners.instance & TRIANGLE_INSTANCE_MASK; }

// ONE_SIDED: some surface's back is passed through.
layout(constant_id = SPEC_ONE_SIDED) const bool ONE_SIDED = false;

// Whether a ray that is not a shadow ray passes through, since it comes from behind.
bool is_hidden(uint word, bool clockwise) {
  return ONE_SIDED && (word & TRIANGLE_ONE_SIDED) != 0u && clockwise != ((word & TRIANGLE_MIRRORED) != 0u);
}

TriangleHit intersect_corners(Shear s, Corners v, float tmin, float tmax) {
  return intersect_triangle(s, v.a, v.b, v.c, frame.box_pad, tmin, tmax);
}

// What rays other than shadow rays meet: `tmax` bounds where the hit counts. A tmin below 0: the ray starts in a place
// that has ranks, behind so much of it.
TriangleHit seen_corners(Shear s, Corners v, float tmin, float tmax) {
  TriangleHit h = intersect_corners(s, v, tmin, tmax);
  h.hit = h.hit && !is_hidden(v.instance, h.clockwise);
  if (RANKED) {
    precise float t = h.t + rank_shift(s, v, h);
    h.t = t;
    h.hit = h.hit && t >= -tmin && t <= tmax;
  }
  return h;
}
#endif
