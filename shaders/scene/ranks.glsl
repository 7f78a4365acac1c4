// SPDX-License-Identifier: MIT
// Surfaces that lie in one place have ranks (engine/scene/coincident.hpp), and a ray meets them in the order of these:
// a hit counts as if it lay `rank` steps further along the ray. A step is what rounding may add to the difference of
// two such hits' t, so their order is that of the ranks; and it is one order of all hits, so the nearest is the same
// whoever is asked first. It only adds to t: a box that begins beyond the nearest hit so far holds none that comes
// before it.
//
// SHADING.md, Coincident surfaces, has the rule and the bound.
#ifndef SHEAF_RANKS_GLSL
#define SHEAF_RANKS_GLSL
#include "lib/common.glsl"
#include "lib/frame.glsl"
#include "interface/scene.h"
#include "scene/memory.glsl"
#include "scene/triangle.glsl"
layout(constant_id = SPEC_RANKED) const bool RANKED = false;

const float STEP = 1.9073486e-6;        // 2^-19
const float STEEPEST = 1024.0;          // 1/cosine: surfaces seen flatter than that are not told apart
const uint LAST_RANK = 7u;

// Seen from behind, volumes come in the opposite order: those that end before those that begin.
uint rank_of(uint word, bool clockwise) {
  uint rank = (word >> TRIANGLE_RANK) & LAST_RANK;
  bool back = clockwise != ((word & TRIANGLE_MIRRORED) != 0u);
  return (word & TRIANGLE_TURNS) != 0u && back ? LAST_RANK + 1u - rank : rank;
}

// A step along the normal, of hits at most `reach` from the frame's origin (the sum of coordinates).
float step_across(float reach) { return STEP * (reach + frame.rank_extent); }

float sum_of(vec3 v) { return abs(v.x) + abs(v.y) + abs(v.z); }

// What a hit's t is moved by.
float rank_shift(Shear s, Corners v, TriangleHit h) {
  uint rank = rank_of(v.instance, h.clockwise);
  if (rank == 0u) return 0.0;
  precise vec3 n = cross(v.b - v.a, v.c - v.a);
  precise float steep = min(length(n) * abs(s.sz) / abs(h.area), STEEPEST);
  precise float shift = float(rank) * step_across(sum_of(s.origin) + abs(h.t)) * steep;
  return shift < INFINITY ? shift : 0.0;
}
#endif
