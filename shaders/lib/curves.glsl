// SPDX-License-Identifier: MIT
// Space-filling curves and the octahedral map: near keys are near rays. Hilbert, not Morton: no bundle straddles a
// jump.
#ifndef SHEAF_CURVES_GLSL
#define SHEAF_CURVES_GLSL

// Unit direction → [0, 1]² (Meyer et al., "On floating-point normal vectors", EGSR 2010).
vec2 octahedral(vec3 d) {
  vec3 a = abs(d);
  vec2 p = d.xy / max(a.x + a.y + a.z, 1e-30);
  if (d.z < 0.0) p = (1.0 - abs(p.yx)) * vec2(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0);
  return clamp(p * 0.5 + 0.5, 0.0, 1.0);
}

uint quantise(float v, uint bits) { return min(uint(clamp(v, 0.0, 1.0) * float(1u << bits)), (1u << bits) - 1u); }

// Place on the 2D Hilbert curve of 2^bits cells a side.
uint hilbert2(uvec2 p, uint bits) {
  uint d = 0u;
  for (uint i = bits; i > 0u; --i) {
    uint s = 1u << (i - 1u);
    uint rx = (p.x & s) != 0u ? 1u : 0u, ry = (p.y & s) != 0u ? 1u : 0u;
    d = (d << 2) | ((3u * rx) ^ ry);
    if (ry == 0u) {
      if (rx == 1u) p = (s - 1u) - (p & (s - 1u));
      p = p.yx;
    }
    p &= s - 1u;
  }
  return d;
}

// The cell at a place of that curve.
uvec2 on_hilbert2(uint place, uint bits) {
  uvec2 p = uvec2(0);
  for (uint i = 0u; i < bits; ++i) {
    uint s = 1u << i, digit = (place >> (2u * i)) & 3u;
    uint rx = digit >> 1, ry = (digit ^ rx) & 1u;
    if (ry == 0u) {
      if (rx == 1u) p = (s - 1u) - p;
      p = p.yx;
    }
    p += s * uvec2(rx, ry);
  }
  return p;
}

// Place on the 5D Hilbert curve: axes to transpose (Skilling, "Programming the Hilbert curve", AIP 707, 2004), then
// interleaved.
uint hilbert5(uint x[5], uint bits) {
  for (uint q = 1u << (bits - 1u); q > 1u; q >>= 1) {
    uint m = q - 1u;
    for (uint i = 0u; i < 5u; ++i) {
      if ((x[i] & q) != 0u) {
        x[0] ^= m;
      } else {
        uint t = (x[0] ^ x[i]) & m;
        x[0] ^= t;
        x[i] ^= t;
      }
    }
  }
  for (uint i = 1u; i < 5u; ++i) x[i] ^= x[i - 1u];
  uint t = 0u;
  for (uint q = 1u << (bits - 1u); q > 1u; q >>= 1)
    if ((x[4] & q) != 0u) t ^= q - 1u;
  uint key = 0u;
  for (uint i = bits; i > 0u; --i)
    for (uint axis = 0u; axis < 5u; ++axis) key = (key << 1) | (((x[axis] ^ t) >> (i - 1u)) & 1u);
  return key;
}

// Floats as integers of the same order, for atomic minima and maxima.
uint ordered(float v) {
  uint b = floatBitsToUint(v);
  return (b & 0x80000000u) != 0u ? ~b : b | 0x80000000u;
}
float unordered(uint b) { return uintBitsToFloat((b & 0x80000000u) != 0u ? b & 0x7FFFFFFFu : ~b); }
#endif
