// SPDX-License-Identifier: MIT
// The rays whose hits generate shades: the i-th of the list at work, or of the camera's where they were not written.
// `hit`: the triangle, NO_INDEX for none, and t.
#ifndef SHEAF_PARENTS_GLSL
#define SHEAF_PARENTS_GLSL
#include "lib/common.glsl"
#include "lib/frame.glsl"
#include "lists/rays.glsl"
#include "scene/textures.glsl"
#include "interface/rays.h"
#include "raster/camera.glsl"
#include "raster/camera_pixels.glsl"
layout(constant_id = SPEC_RASTER) const bool RASTER = true;
BUFFER(ROLE_VISIBILITY, readonly, uint64_t, visibility);

struct Parent {
  Ray ray;
  vec3 weight;
  float coverage;
  uint pixel;
  uint medium;
  uint past;  // RAY_PAST
  float cone_width, cone_spread;
};

Parent load_parent(ListAddresses list, uint kind, uint i, out uvec2 hit) {
  uint slot = kind == KIND_PRIMARY ? i : load_slot(list.order, i);
  hit = unpack32(hit_at(list.hits, slot).v);
  Parent p;
  p.ray = load_ray(list.rays, slot);
  RayPayload carried = load_ray_payload(list.rays, slot);
  p.weight = carried.weight;
  p.coverage = carried.coverage;
  p.medium = carried.medium;
  p.past = carried.past;
  p.pixel = load_ray_pixel(list.rays, slot);
  vec2 cone = TEXTURED ? load_ray_cone(list.rays, slot) : vec2(0);
  p.cone_width = cone.x;
  p.cone_spread = cone.y;
  return p;
}

// A ray of the camera, made again as generate_primary and raster made it.
Parent camera_parent(uint i, out uvec2 hit) {
  uvec2 at = pixel_of(i);
  Parent p;
  p.ray = camera_ray(frame.tile_x + at.x, frame.tile_y + at.y, frame.place);
  p.weight = vec3(1);
  p.coverage = 1.0;
  p.medium = 0u;
  p.past = 0u;
  p.pixel = at.y * frame.tile_width + at.x;
  p.cone_width = frame.cone_width;
  p.cone_spread = frame.cone_spread;
  hit = unpack32(visibility[p.pixel]);
  return p;
}
#endif
