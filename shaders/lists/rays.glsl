// SPDX-License-Identifier: MIT
// A list: rays in slots, their hits, and an order (slot numbers), each known by its address, for no descriptor's bounds
// to be checked (memory.glsl). Rays are read two words per load. First come the parts of `frame.capacity` rays that
// tracers read, RAY_PART words each, then as many of what the rays are for, then the slots' pixels, one word each:
// compaction asks for nothing else.
#ifndef SHEAF_RAYS_GLSL
#define SHEAF_RAYS_GLSL
#include "interface/rays.h"
#include "lib/common.glsl"
#include "lib/frame.glsl"
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer RayPairs { uint64_t pair[RAY_PART / 2]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer RayPixel { uint v; };

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer ListSlot { uint v; };
// Low word: triangle; high: t.
layout(buffer_reference, scalar, buffer_reference_align = 8) coherent buffer ListHit { uint64_t v; };

uint load_slot(uvec2 order, uint i) { return ListSlot(pack64(order) + uint64_t(4u * i)).v; }
void store_slot(uvec2 order, uint i, uint slot) { ListSlot(pack64(order) + uint64_t(4u * i)).v = slot; }
ListHit hit_at(uvec2 hits, uint slot) { return ListHit(pack64(hits) + uint64_t(8u * slot)); }

struct Ray {
  vec3 origin;
  vec3 direction;
  float tmin;
  float tmax;
};

struct RayPayload {  // what the ray is for
  vec3 weight;
  float coverage;
  uint medium;
  uint past;  // RAY_PAST
};

// Offsets fit 32 bits: a buffer is at most 4 GiB (checked where it is made).
RayPairs ray_pairs(uvec2 list, uint slot, uint word) {
  uint place = word < RAY_PART ? slot : frame.capacity + slot;
  return RayPairs(pack64(list) + uint64_t(place * (4u * RAY_PART)));
}
RayPixel ray_pixel(uvec2 list, uint slot) {
  return RayPixel(pack64(list) + uint64_t(4u * (frame.capacity * RAY_WORDS + slot)));
}

vec2 load_ray_pair(uvec2 list, uint slot, uint word) {
  return uintBitsToFloat(unpack32(ray_pairs(list, slot, word).pair[word % RAY_PART / 2u]));
}
void store_ray_pair(uvec2 list, uint slot, uint word, float first, float second) {
  ray_pairs(list, slot, word).pair[word % RAY_PART / 2u] = pack64(floatBitsToUint(vec2(first, second)));
}

Ray load_ray(uvec2 list, uint slot) {
  vec2 a = load_ray_pair(list, slot, RAY_ORIGIN), b = load_ray_pair(list, slot, RAY_ORIGIN + 2u),
       c = load_ray_pair(list, slot, RAY_DIRECTION + 1u), d = load_ray_pair(list, slot, RAY_TMIN);
  return Ray(vec3(a, b.x), vec3(b.y, c), d.x, d.y);
}

uint load_ray_medium(uvec2 list, uint slot) { return floatBitsToUint(load_ray_pair(list, slot, RAY_MEDIUM).x); }

RayPayload load_ray_payload(uvec2 list, uint slot) {
  vec2 a = load_ray_pair(list, slot, RAY_WEIGHT), b = load_ray_pair(list, slot, RAY_WEIGHT + 2u);
  uvec2 c = floatBitsToUint(load_ray_pair(list, slot, RAY_MEDIUM));
  return RayPayload(vec3(a, b.x), b.y, c.x, c.y);
}

void store_ray(uvec2 list, uint slot, Ray ray, uint pixel, RayPayload carried) {
  store_ray_pair(list, slot, RAY_ORIGIN, ray.origin.x, ray.origin.y);
  store_ray_pair(list, slot, RAY_ORIGIN + 2u, ray.origin.z, ray.direction.x);
  store_ray_pair(list, slot, RAY_DIRECTION + 1u, ray.direction.y, ray.direction.z);
  store_ray_pair(list, slot, RAY_TMIN, ray.tmin, ray.tmax);
  store_ray_pair(list, slot, RAY_WEIGHT, carried.weight.x, carried.weight.y);
  store_ray_pair(list, slot, RAY_WEIGHT + 2u, carried.weight.z, carried.coverage);
  store_ray_pair(list, slot, RAY_MEDIUM, uintBitsToFloat(carried.medium), uintBitsToFloat(carried.past));
  ray_pixel(list, slot).v = pixel;
}

vec2 load_ray_cone(uvec2 list, uint slot) { return load_ray_pair(list, slot, RAY_CONE); }
void store_ray_cone(uvec2 list, uint slot, vec2 cone) { store_ray_pair(list, slot, RAY_CONE, cone.x, cone.y); }

uint load_ray_pixel(uvec2 list, uint slot) { return ray_pixel(list, slot).v; }
void store_no_ray(uvec2 list, uint slot) { ray_pixel(list, slot).v = NO_INDEX; }
#endif
