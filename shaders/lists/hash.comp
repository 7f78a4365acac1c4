// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// Keys (R 4.2, S): reflection and refraction rays by cell of the origin in a grid over the batch and of the direction
// on its map, as one space of five dimensions; shadow rays by light, then by direction from it (point, spot) or place
// across it (directional). All along Hilbert curves.
#define COMPUTE
#include "lib/common.glsl"
#include "interface/scene.h"
#include "interface/push/lists.h"
#include "lib/push.glsl"
#include "lists/rays.glsl"
#include "lib/counters.glsl"
#include "lib/curves.glsl"
BUFFER(ROLE_KEYS, writeonly, uint, keys);
BUFFER(ROLE_LIGHTS, readonly, Light, lights);
PUSH(HashPush);

vec3 batch_place(vec3 o) {  // in [0, 1]³; a batch without extent along an axis has one cell there
  vec3 lo, hi;
  for (uint axis = 0u; axis < 3u; ++axis) {
    lo[axis] = unordered(counters[COUNT_BOUNDS + axis]);
    hi[axis] = unordered(counters[COUNT_BOUNDS + 3u + axis]);
  }
  vec3 size = hi - lo;
  float largest = max(max(size.x, size.y), max(size.z, 1e-30));  // cubic cells
  return clamp((o - lo) / largest, 0.0, 1.0);
}

uint shadow_key(Ray ray, uint light) {
  uint cell;
  if (lights[light].kind == LIGHT_DIRECTIONAL) {
    vec3 d = lights[light].direction;
    vec3 u = normalize(abs(d.y) < 0.9 ? cross(d, vec3(0, 1, 0)) : cross(d, vec3(1, 0, 0)));
    vec3 v = cross(d, u);
    vec3 p = batch_place(ray.origin) - 0.5;
    vec2 across = vec2(dot(p, u), dot(p, v)) * 0.5774 + 0.5;  // |p| ≤ √3/2
    cell = hilbert2(uvec2(quantise(across.x, push.bits), quantise(across.y, push.bits)), push.bits);
  } else {
    vec2 o = octahedral(ray.direction);
    cell = hilbert2(uvec2(quantise(o.x, push.bits), quantise(o.y, push.bits)), push.bits);
  }
  return push.light_bits == 0u ? cell : ((light & ((1u << push.light_bits) - 1u)) << (2u * push.bits)) | cell;
}

uint secondary_key(Ray ray) {
  vec3 p = batch_place(ray.origin);
  vec2 o = octahedral(ray.direction);
  return hilbert5(uint[5](quantise(o.x, push.bits), quantise(o.y, push.bits), quantise(p.x, push.bits),
                          quantise(p.y, push.bits), quantise(p.z, push.bits)),
                  push.bits);
}

void main() {
  uint i = global_index();
  if (i >= counters[COUNT_RAYS + push.kind]) return;
  uint slot = load_slot(ray_list.order, i);
  Ray ray = load_ray(ray_list.rays, slot);
  keys[i] = push.kind == KIND_SHADOW ? shadow_key(ray, load_ray_medium(ray_list.rays, slot)) : secondary_key(ray);
}
