// SPDX-License-Identifier: MIT
// Whole numbers in [0, 2^23) to integers: next to 2^23 they are the lowest bits. A conversion, which must also see to what does not
// fit, goes lane by lane on a CPU device.
#ifndef SHEAF_CONVERT_GLSL
#define SHEAF_CONVERT_GLSL
uint to_uint(float v) { return floatBitsToUint(v + 8388608.0) & 0x7FFFFFu; }
uvec2 to_uint(vec2 v) { return uvec2(to_uint(v.x), to_uint(v.y)); }

// Of a number that is not 0: its lowest set bit alone is a power of two, whose float says which. (findLSB goes lane by lane.)
uint lowest_bit(uint v) { return ((floatBitsToUint(float(int(v & (0u - v)))) >> 23) & 255u) - 127u; }
#endif
