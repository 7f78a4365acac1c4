// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// Adds the light of the shadow rays that got through, and counts: ray by ray, or, where there are several lights,
// parent by parent, whose rays' light is one sum.
#define COMPUTE
#include "lib/common.glsl"
#include "interface/shading.h"
#include "interface/push/shade.h"
#include "lib/push.glsl"
#include "lists/rays.glsl"
#include "shade/accumulate.glsl"
#include "lib/counters.glsl"
#include "lib/counting.glsl"
BUFFER(ROLE_OPTICAL_DEPTH, readonly, int, optical_depth);
layout(constant_id = SPEC_TRANSLUCENT) const bool TRANSLUCENT = true;
layout(constant_id = SPEC_BY_PARENT) const bool BY_PARENT = false;
PUSH(ShadePush);

// Of a ray that got through.
vec3 light_of(uint slot) {
  vec3 light = load_ray_payload(ray_list.rays, slot).weight;
  if (TRANSLUCENT) {
    ivec3 depth =
        max(ivec3(optical_depth[3u * slot], optical_depth[3u * slot + 1u], optical_depth[3u * slot + 2u]), ivec3(0));
    light *= exp2(-vec3(depth) / float(OPTICAL_STEP));
  }
  return light;
}

bool is_blocked(uint slot) { return unpack32(hit_at(ray_list.hits, slot).v).x != NO_INDEX; }

void add_light(uint pixel, uint64_t sum[4]) {
  if (push.sums == SUMS_OWN)
    add_alone(pixel, sum, 3u, false);
  else
    accumulate(pixel, sum, 3u);
}

void shade_parent(uint i) {
  if (i >= counters[COUNT_RAYS + push.kind]) return;
  uint parents = counters[COUNT_PARENTS], blocked = 0u, pixel = NO_INDEX;
  uint slot = i + (push.kind == KIND_REFRACTION ? counters[COUNT_RAYS + KIND_REFLECTION] : 0u);
  uint64_t sum[4] = uint64_t[4](0ul, 0ul, 0ul, 0ul);
  for (uint k = 0u; k < frame.lights; ++k, slot += parents) {
    uint of_ray = load_ray_pixel(ray_list.rays, slot);
    if (of_ray == NO_INDEX) continue;  // no ray
    if (is_blocked(slot)) {
      ++blocked;
      continue;
    }
    pixel = of_ray;
    uint64_t more[4] = fixed_point(vec4(light_of(slot), 0.0));
    for (uint c = 0u; c < 3u; ++c) sum[c] += more[c];
  }
  count_tests(KIND_SHADOW, STAT_HITS, blocked);
  if (pixel != NO_INDEX) add_light(pixel, sum);
}

void shade_ray(uint i) {
  if (i >= counters[COUNT_RAYS + KIND_SHADOW]) return;
  uint slot = load_slot(ray_list.order, i);
  bool blocked = is_blocked(slot);
  count_tests(KIND_SHADOW, STAT_HITS, blocked ? 1u : 0u);
  if (!blocked) add_light(load_ray_pixel(ray_list.rays, slot), fixed_point(vec4(light_of(slot), 0.0)));
}

void main() {
  if (BY_PARENT)
    shade_parent(global_index());
  else
    shade_ray(global_index());
}
