// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// The surface layers (--aov) of the camera's first hits: structure of arrays, word w of a pixel at w · pixels + pixel.
#define COMPUTE
#include "lib/common.glsl"
#include "interface/shading.h"
#include "interface/push/push.h"
#include "lib/push.glsl"
#include "lists/rays.glsl"
#include "scene/scene.glsl"
#include "shade/surface.glsl"
BUFFER(ROLE_LAYERS, writeonly, float, layers);
PUSH(NoPush);

void main() {
  uint i = global_index(), pixels = frame.tile_width * frame.tile_height;
  bool is_active = i < pixels;
  i = min(i, pixels - 1u);
  uint triangle = unpack32(hit_at(ray_list.hits, i).v).x, pixel = load_ray_pixel(ray_list.rays, i);
  bool hits = is_active && triangle != NO_INDEX;
  float words[LAYER_WORDS];
  if (continues(hits)) {
    triangle = value_or_first(triangle, hits);
    Ray ray = load_ray(ray_list.rays, i);
    Corners corners = load_triangle(triangle);
    TriangleHit at = project_to_triangle(make_shear(ray.origin, ray.direction), corners.a, corners.b, corners.c, 0.0);
    Material material;
    Surface s = surface_at(triangle, at.barycentric, ray.direction, 0.0, material);
    words[LAYER_DEPTH] = dot(s.point - frame.eye, frame.forward);
    for (uint c = 0u; c < 3u; ++c) {
      words[LAYER_NORMAL + c] = s.normal[c];
      words[LAYER_POSITION + c] = s.point[c];
      words[LAYER_ALBEDO + c] = s.base[c];
    }
    words[LAYER_UV] = s.uv.x;
    words[LAYER_UV + 1u] = s.uv.y;
    words[LAYER_OBJECT] = uintBitsToFloat(s.object);
    words[LAYER_MATERIAL] = uintBitsToFloat(material.id);
  }
  if (!hits) {
    for (uint w = 0u; w < LAYER_WORDS; ++w) words[w] = 0.0;
    words[LAYER_DEPTH] = INFINITY;
  }
  if (!is_active) return;
  for (uint w = 0u; w < LAYER_WORDS; ++w) layers[w * pixels + pixel] = words[w];
}
