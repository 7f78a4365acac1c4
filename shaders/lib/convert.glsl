// SPDX-License-Identifier: MIT
// Integer arithmetic that a CPU device would do lane by lane, by floats.
//
// Whole numbers in [0, 2^23) to integers: next to 2^23 they are the lowest bits. (A conversion must also see to what
// does not fit.)
#ifndef SHEAF_CONVERT_GLSL
#define SHEAF_CONVERT_GLSL
uint to_uint(float v) { return floatBitsToUint(v + 8388608.0) & 0x7FFFFFu; }
uvec2 to_uint(vec2 v) { return uvec2(to_uint(v.x), to_uint(v.y)); }

// Quotient and remainder of n < 2^31 by d < 2^24. Rounding n (2^-24) and dividing (2.5 ulps) put a quotient below 2^21
// off by less than one, so that its floor is off by one at most, which the remainder tells. (A division of integers
// goes lane by lane.)
uvec2 divided(uint n, uint d) {
  int quotient = int(to_uint(floor(float(int(n)) / float(int(d))))), rest = int(n) - quotient * int(d);
  int off = rest < 0 ? -1 : rest >= int(d) ? 1 : 0;
  return uvec2(quotient + off, rest - off * int(d));
}

// Of a number that is not 0: its lowest set bit alone is a power of two, whose float says which. (findLSB goes lane by
// lane.)
uint lowest_bit(uint v) { return ((floatBitsToUint(float(int(v & (0u - v)))) >> 23) & 255u) - 127u; }
#endif
