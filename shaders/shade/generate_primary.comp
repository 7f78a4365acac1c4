// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// The camera's rays of a batch: one sample of every pixel of a tile, or several of the pixels that adaptive sampling
// goes on with. Under `--primary raster` their hits come with them: the visibility buffer names the triangle and its t.
#define COMPUTE
#include "lib/common.glsl"
#include "interface/push/push.h"
#include "lib/push.glsl"
#include "lists/rays.glsl"
#include "raster/camera.glsl"
#include "lib/counters.glsl"
#include "raster/camera_pixels.glsl"
BUFFER(ROLE_STATS, coherent, uint64_t, stats);
BUFFER(ROLE_VISIBILITY, readonly, uint64_t, visibility);
BUFFER(ROLE_ACTIVE_PIXELS, readonly, uint, active_pixels);
BUFFER(ROLE_SAMPLE_PLACES, readonly, vec2, sample_places);
layout(constant_id = SPEC_RASTER) const bool RASTER = true;
layout(constant_id = SPEC_ADAPTIVE) const bool ADAPTIVE = false;
layout(constant_id = SPEC_TEXTURED) const bool TEXTURED = true;
PUSH(NoPush);

void main() {
  uint i = global_index();
  uint count = frame.batch_rays;
  if (i == 0u) {
    counters[COUNT_SLOTS + KIND_PRIMARY] = count;
    if (RASTER) {
      counters[COUNT_RAYS + KIND_PRIMARY] = count;
      stats[KIND_PRIMARY * STAT_FIELDS + STAT_RAYS] += uint64_t(count);
    }
  }
  if (i >= count) return;
  uvec2 at;
  vec2 place = frame.place;
  if (ADAPTIVE) {
    uint which = active_pixels[i / frame.batch_samples];
    at = uvec2(which % frame.tile_width, which / frame.tile_width);
    place = sample_places[frame.sample_index + i % frame.batch_samples];
  } else {
    at = pixel_of(i);
  }
  uint pixel = at.y * frame.tile_width + at.x;
  Ray ray = camera_ray(frame.tile_x + at.x, frame.tile_y + at.y, place);
  store_ray(ray_list.rays, i, ray, pixel, RayPayload(vec3(1), 1.0, 0u, 0u));
  if (TEXTURED) store_ray_cone(ray_list.rays, i, vec2(frame.cone_width, frame.cone_spread));
  hit_at(ray_list.hits, i).v = RASTER ? visibility[pixel] : pack64(uvec2(NO_INDEX));
}
