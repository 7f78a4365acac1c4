// SPDX-License-Identifier: MIT
// Sums a pixel's light in 32.32 fixed point: integer addition has no order, so neither has the picture.
#ifndef SHEAF_ACCUMULATE_GLSL
#define SHEAF_ACCUMULATE_GLSL
#include "lib/common.glsl"
#include "lib/frame.glsl"
#include "lib/convert.glsl"
// R G B alpha.
layout(buffer_reference, scalar, buffer_reference_align = 8) coherent buffer PixelSums { uint64_t channel[4]; };
PixelSums sums_of(uint pixel) { return PixelSums(pack64(frame.sums_at) + uint64_t(32u * pixel)); }

uint64_t to_fixed(float v) {
  if (!(v > 0.0)) return 0ul;  // negative, zero, NaN
  v = min(v, 1.0e9);
  // Sixteen bits at a time, each exact; see to_uint.
  float whole = floor(v), high = floor(whole * (1.0 / 65536.0)), rest = (v - whole) * 65536.0, low = floor(rest);
  return pack64(uvec2((to_uint(low) << 16) | to_uint(floor((rest - low) * 65536.0)),
                      (to_uint(high) << 16) | to_uint(whole - high * 65536.0)));
}

void accumulate(uint pixel, uint64_t sum[4], uint channels) {
  for (uint c = 0u; c < channels; ++c)
    if (sum[c] != 0ul) atomicAdd(sums_of(pixel).channel[c], sum[c]);
}

// Where no other ray of the dispatch is the pixel's. What the sums were before the first sample does not matter.
void add_alone(uint pixel, uint64_t sum[4], uint channels, bool first) {
  PixelSums sums = sums_of(pixel);
  if (!first)
    for (uint c = 0u; c < channels; ++c) sum[c] += sums.channel[c];
  for (uint c = 0u; c < channels; ++c) sums.channel[c] = sum[c];
}

uint64_t[4] fixed_point(vec4 v) { return uint64_t[4](to_fixed(v.r), to_fixed(v.g), to_fixed(v.b), to_fixed(v.a)); }
#endif
