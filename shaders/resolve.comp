// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// The mean of a pixel's samples, from fixed point to float: linear, premultiplied.
#define COMPUTE
#include "common.glsl"
#include "rays.glsl"
BUFFER(ROLE_ACCUMULATION, readonly, uvec2, accumulation);
BUFFER(ROLE_OUTPUT, writeonly, float, pixels);
layout(push_constant) uniform Push { float inverse_samples; } push;

void main() {
  uint i = global_index();
  if (i >= 4u * frame.tile_width * frame.tile_height) return;
  uvec2 v = accumulation[i];
  float value = (float(v.y) + float(v.x) * (1.0 / 4294967296.0)) * push.inverse_samples;
  pixels[i] = i % 4u == 3u ? min(value, 1.0) : value;
}
