// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// The camera's rays of a tile, one a pixel. Under `--primary raster` their hits come with them: the visibility buffer names
// the triangle and its t.
#define COMPUTE
#include "common.glsl"
#include "rays.glsl"
#include "camera.glsl"
#include "lists.glsl"
BUFFER(ROLE_RAYS, writeonly, float, rays);
BUFFER(ROLE_HITS, writeonly, uvec2, hits);
BUFFER(ROLE_STATS, coherent, uint64_t, stats);
BUFFER(ROLE_VISIBILITY, readonly, uvec2, visibility);
layout(constant_id = 1) const bool RASTER = true;

void main() {
  uint i = global_index();
  uint count = frame.tile_width * frame.tile_height;
  if (i == 0u) {
    counters[COUNT_SLOTS + KIND_PRIMARY] = count;
    if (RASTER) {
      counters[COUNT_RAYS + KIND_PRIMARY] = count;
      stats[KIND_PRIMARY * STAT_FIELDS + STAT_RAYS] += uint64_t(count);
    }
  }
  if (i >= count) return;
  Ray ray = camera_ray(frame.tile_x + i % frame.tile_width, frame.tile_y + i / frame.tile_width);
  STORE_RAY(rays, i, ray.origin, ray.direction, ray.tmin, ray.tmax, vec3(1));
  RAYS(rays, RAY_PIXEL, i) = uintBitsToFloat(i);
  RAYS(rays, RAY_MEDIUM, i) = 0.0;
  RAYS(rays, RAY_COVERAGE, i) = 1.0;
  hits[i] = RASTER ? visibility[i] : uvec2(NO_INDEX);
}
