// SPDX-License-Identifier: MIT
// Reductions over a subgroup of LANES, all of them active. With few lanes by exchange: three permutations, where a CPU device
// runs the built-in ones as a loop over lanes through memory (120 cycles each, measured on llvmpipe).
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_shuffle : require

uint or_lanes(uint x) {
  if (LANES > 8u) return subgroupOr(x);
  for (uint m = 1u; m < LANES; m <<= 1) x |= subgroupShuffleXor(x, m);
  return x;
}

float max_lanes(float x) {
  if (LANES > 8u) return subgroupMax(x);
  for (uint m = 1u; m < LANES; m <<= 1) {
    float y = subgroupShuffleXor(x, m);
    x = y > x ? y : x;
  }
  return x;
}

float sum_lanes(float x) {
  if (LANES > 8u) return subgroupAdd(x);
  for (uint m = 1u; m < LANES; m <<= 1) x += subgroupShuffleXor(x, m);
  return x;
}

float min_lanes(float x) { return -max_lanes(-x); }
vec3 max_lanes(vec3 x) { return vec3(max_lanes(x.x), max_lanes(x.y), max_lanes(x.z)); }
vec3 min_lanes(vec3 x) { return -max_lanes(-x); }
vec3 sum_lanes(vec3 x) { return vec3(sum_lanes(x.x), sum_lanes(x.y), sum_lanes(x.z)); }

// A bit a lane, of the first 32.
uint lanes_where(bool b) { return LANES > 8u ? subgroupBallot(b).x : or_lanes(b ? 1u << gl_SubgroupInvocationID : 0u); }
bool any_lane(bool b) { return LANES > 8u ? subgroupBallot(b) != uvec4(0) : or_lanes(b ? 1u : 0u) != 0u; }

// Arrays of a value a vector of rays: an element is picked by comparing with every index, which costs a CPU device a third of
// what a gather does. V is the same in all lanes.
#define PICK(result, array, v) \
  { \
    result = array[0]; \
    [[unroll]] for (uint pick_ = 1u; pick_ < VECTORS; ++pick_) result = (v) == pick_ ? array[pick_] : result; \
  }
#define PUT(array, v, value) \
  [[unroll]] for (uint put_ = 0u; put_ < VECTORS; ++put_) array[put_] = (v) == put_ ? value : array[put_]
