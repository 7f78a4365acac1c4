// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// The raster pass pulls world-space triangles; clip positions only decide coverage, depth comes from the fragment.
#include "lib/common.glsl"
#include "lists/rays.glsl"
#include "scene/memory.glsl"
layout(location = 0) flat out uint triangle;
layout(location = 1) flat out vec3 corner_a;
layout(location = 2) flat out vec3 corner_b;
layout(location = 3) flat out vec3 corner_c;
layout(location = 4) flat out uint word;

void main() {
  triangle = gl_VertexIndex / 3u;
  uint corner = gl_VertexIndex % 3u;
  Corners c = load_triangle(triangle);
  corner_a = c.a;
  corner_b = c.b;
  corner_c = c.c;
  word = c.instance;
  vec3 p = corner == 0u ? c.a : corner == 1u ? c.b : c.c;
  vec3 v = p - frame.eye;
  float x = dot(v, frame.right) / dot(frame.right, frame.right);
  float y = dot(v, frame.up) / dot(frame.up, frame.up);
  float z = dot(v, frame.forward);
  // The sample's offset in its pixel moves the picture the other way; pixel centres are where rasterisers sample.
  vec2 shift = (1.0 - 2.0 * frame.place) / vec2(frame.width, frame.height);
  // Clip z only keeps what lies before the near plane (or within rounding of the eye) away from w = 0.
  float near = max(frame.near, frame.box_pad);
  if (frame.orthographic != 0u)
    gl_Position = vec4(x + shift.x, -y + shift.y, 0.5, 1.0);
  else
    gl_Position = vec4(x + shift.x * z, -y + shift.y * z, 0.5 * (z - near), z);
}
