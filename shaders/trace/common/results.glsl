// SPDX-License-Identifier: MIT
// Where intersect leaves what it found: (triangle, t) a slot, which read as one 64-bit number orders by t, then by
// triangle; and the optical depth of shadow rays through surfaces that let light pass.
#ifndef SHEAF_RESULTS_GLSL
#define SHEAF_RESULTS_GLSL
#include "lib/common.glsl"
#include "lists/rays.glsl"
#include "trace/common/candidate.glsl"
BUFFER(ROLE_OPTICAL_DEPTH, coherent, int, optical_depth);  // 3 a slot

uint64_t pack_hit(float t, uint triangle) {
  return (uint64_t(floatBitsToUint(max(t, 0.0))) << 32) | uint64_t(triangle);
}
const uint64_t NO_HIT = 0xFFFFFFFFFFFFFFFFul;

void store_nearest(uvec2 hits, uint slot, Nearest best) {
  hit_at(hits, slot).v = best.triangle == NO_INDEX ? NO_HIT : pack_hit(best.t, best.triangle);
}

void store_shade(uvec2 hits, uint slot, Shade shade) {
  hit_at(hits, slot).v = shade.blocked ? pack_hit(shade.t, shade.triangle) : NO_HIT;
  if (TRANSLUCENT)
    for (uint c = 0u; c < 3u; ++c) optical_depth[3u * slot + c] = shade.optical_depth[c];
}
#endif
