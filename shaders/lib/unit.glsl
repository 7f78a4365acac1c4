// SPDX-License-Identifier: MIT
// Directions of vectors of any size. Squares and cross products leave the range of floats from 1e19 on, and below
// 1e-19: vectors are scaled first, by powers of two, which changes no bit of a result that was in range.
#ifndef SHEAF_UNIT_GLSL
#define SHEAF_UNIT_GLSL

float max_of(vec3 v) { return max(max(v.x, v.y), v.z); }

// 2^-k where 2^k <= size < 2^(k+1), as far as floats go.
float inverse_scale(float size) {
  return uintBitsToFloat(0x7F000000u - clamp(floatBitsToUint(size) & 0x7F800000u, 0x00800000u, 0x7E800000u));
}

vec3 of_size_one(vec3 v) { return v * inverse_scale(max_of(abs(v))); }

vec3 safe_normalize(vec3 v, vec3 otherwise) {
  v = of_size_one(v);
  float size = length(v);
  return size > 0.0 && size < uintBitsToFloat(0x7F800000u) ? v / size : otherwise;
}

// Unit, by the right-hand rule; `otherwise` where the triangle has no area. Halves, because a difference may be twice
// the largest float.
vec3 triangle_normal(vec3 a, vec3 b, vec3 c, vec3 otherwise) {
  vec3 e1 = of_size_one(0.5 * b - 0.5 * a), e2 = of_size_one(0.5 * c - 0.5 * a);
  return safe_normalize(cross(e1, e2), otherwise);
}
#endif
