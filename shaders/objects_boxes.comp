// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// Padded boxes of all triangles, as the driver's acceleration structure takes them (VkAabbPositionsKHR).
#define COMPUTE
#include "common.glsl"
#include "rays.glsl"
BUFFER(ROLE_TRIANGLE_A, readonly, vec3, triangle_a);
BUFFER(ROLE_TRIANGLE_B, readonly, vec3, triangle_b);
BUFFER(ROLE_TRIANGLE_C, readonly, vec3, triangle_c);
BUFFER(ROLE_BOXES, writeonly, vec3, boxes);

void main() {
  uint i = global_index();
  if (i >= frame.triangles) return;
  vec3 a = triangle_a[i], b = triangle_b[i], c = triangle_c[i];
  // Twice box_pad: the driver's own slab test rounds too, and it must not lose a box that ours enters.
  boxes[2u * i] = min(min(a, b), c) - 2.0 * frame.box_pad;
  boxes[2u * i + 1u] = max(max(a, b), c) + 2.0 * frame.box_pad;
}
