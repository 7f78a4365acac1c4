// SPDX-License-Identifier: MIT
// Frustums by address, a pair of words at a time (see memory.glsl): plane, inverse, (axis, octant, endless, settled),
// nothing, side, reciprocal.
#ifndef SHEAF_FRUSTUM_MEMORY_GLSL
#define SHEAF_FRUSTUM_MEMORY_GLSL
#include "interface/hierarchy.h"
#include "lib/common.glsl"
#include "trace/cells/frustum.glsl"
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer FrustumPairs { uint64_t pair[FRUSTUM_WORDS / 2]; };

FrustumPairs frustum_pairs(uvec2 at, uint i) { return FrustumPairs(pack64(at) + uint64_t(i * (4u * FRUSTUM_WORDS))); }

Frustum load_frustum(uvec2 at, uint i) {
  FrustumPairs words = frustum_pairs(at, i);
  uvec2 w0 = unpack32(words.pair[0]), w1 = unpack32(words.pair[1]), w2 = unpack32(words.pair[2]),
        w3 = unpack32(words.pair[3]), w4 = unpack32(words.pair[4]), w5 = unpack32(words.pair[5]);
  return Frustum(uintBitsToFloat(w0.x), uintBitsToFloat(w0.y), w1.x & 3u, (w1.x >> 2) & 7u, (w1.x & 32u) != 0u,
                 (w1.x & 64u) != 0u, uintBitsToFloat(uvec4(w2, w3)), uintBitsToFloat(uvec4(w4, w5)));
}

void store_frustum(uvec2 at, uint i, Frustum f) {
  FrustumPairs words = frustum_pairs(at, i);
  words.pair[0] = pack64(floatBitsToUint(vec2(f.plane, f.inverse)));
  words.pair[1] = pack64(uvec2(f.axis | (f.octant << 2) | (f.endless ? 32u : 0u) | (f.settled ? 64u : 0u), 0u));
  words.pair[2] = pack64(floatBitsToUint(f.side.xy));
  words.pair[3] = pack64(floatBitsToUint(f.side.zw));
  words.pair[4] = pack64(floatBitsToUint(f.reciprocal.xy));
  words.pair[5] = pack64(floatBitsToUint(f.reciprocal.zw));
}
#endif
