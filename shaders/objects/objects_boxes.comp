// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// Padded boxes of all triangles, as the driver's acceleration structure takes them (VkAabbPositionsKHR).
#define COMPUTE
#include "lib/common.glsl"
#include "lists/rays.glsl"
#include "scene/memory.glsl"
BUFFER(ROLE_BOXES, writeonly, vec3, boxes);

void main() {
  uint i = global_index();
  if (i >= frame.triangles) return;
  Corners v = load_triangle(i);
  // Twice box_pad: the driver's own slab test rounds too, and it must not lose a box that ours enters.
  boxes[2u * i] = min(min(v.a, v.b), v.c) - 2.0 * frame.box_pad;
  boxes[2u * i + 1u] = max(max(v.a, v.b), v.c) + 2.0 * frame.box_pad;
}
