// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// The mean of a pixel's samples, from fixed point to float: linear, premultiplied.
#define COMPUTE
#include "lib/common.glsl"
#include "interface/push/shade.h"
#include "lib/push.glsl"
#include "lists/rays.glsl"
#include "shade/accumulate.glsl"
layout(buffer_reference, scalar, buffer_reference_align = 8) writeonly buffer PixelPairs { uint64_t pair[2]; };
PUSH(ResolvePush);

float mean_of(uint64_t sum) {
  uvec2 v = unpack32(sum);
  return (float(v.y) + float(v.x) * (1.0 / 4294967296.0)) * push.inverse_samples;
}

void main() {
  // What is past the last pixel writes that one again, the same bits: without an `if` loads and stores need no mask.
  uint i = min(global_index(), frame.tile_width * frame.tile_height - 1u);
  PixelSums sums = sums_of(i);
  PixelPairs pixel = PixelPairs(pack64(push.output_at) + uint64_t(16u * i));
  pixel.pair[0] = pack64(floatBitsToUint(vec2(mean_of(sums.channel[0]), mean_of(sums.channel[1]))));
  pixel.pair[1] = pack64(floatBitsToUint(vec2(mean_of(sums.channel[2]), min(mean_of(sums.channel[3]), 1.0))));
}
