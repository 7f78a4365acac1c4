// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// Adds the light of the shadow rays that got through, and counts.
#define COMPUTE
#include "common.glsl"
#include "rays.glsl"
#include "accumulate.glsl"
#include "lists.glsl"
#include "counting.glsl"
BUFFER(ROLE_OPTICAL_DEPTH, readonly, int, optical_depth);
layout(constant_id = SPEC_TRANSLUCENT) const bool TRANSLUCENT = true;
layout(push_constant) uniform Push {
  uint sums;  // SUMS_…, of the pixels
  PUSH_LIST
} push;

void main() {
  uint i = global_index();
  if (i >= counters[COUNT_RAYS + KIND_SHADOW]) return;
  uint slot = load_slot(push.order, i);
  bool blocked = unpack32(hit_at(push.hits, slot).v).x != NO_INDEX;
  count_tests(KIND_SHADOW, STAT_HITS, blocked ? 1u : 0u);
  if (blocked) return;
  vec3 light = load_ray_load(push.rays, slot).weight;
  if (TRANSLUCENT) {
    ivec3 stops = max(ivec3(optical_depth[3u * slot], optical_depth[3u * slot + 1u], optical_depth[3u * slot + 2u]), ivec3(0));
    light *= exp2(-vec3(stops) / float(OPTICAL_STEP));
  }
  uint pixel = load_ray_pixel(push.rays, slot);
  if (push.sums == SUMS_OWN)
    add_alone(pixel, vec4(light, 0.0), 3u, false);
  else
    accumulate_rgb(pixel, light);
}
