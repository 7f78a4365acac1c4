// SPDX-License-Identifier: MIT
// Exchanges within a subgroup of LANES, all of them active. Measured on llvmpipe: with 8 lanes a shuffle is one
// permutation; with 16 it goes lane by lane through memory, as the built-in reductions always do (15 cycles per lane),
// but one lane's value is handed round in two instructions. So reductions there are three permutations, or all lanes'
// values in turn.
#ifndef SHEAF_LANES_GLSL
#define SHEAF_LANES_GLSL
#include "lib/common.glsl"
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_shuffle : require

layout(constant_id = SPEC_LANES) const uint LANES = 8;  // of a subgroup

const bool PERMUTED = LANES <= 8u, IN_TURN = LANES == 16u && WORKERS > 0u;

// A lane's value for all; `from` is the same in all lanes.
#define OF_LANE(value, from) (IN_TURN ? subgroupBroadcast(value, from) : subgroupShuffle(value, from))

// Of the first lanes alone, `count` of them, a constant, where no other has anything.
uint or_lanes(uint x, uint count) {
  if (PERMUTED) {
    for (uint m = 1u; m < LANES; m <<= 1) x |= subgroupShuffleXor(x, m);
    return x;
  }
  if (!IN_TURN) return subgroupOr(x);
  uint all = 0u;
  for (uint k = 0u; k < count; ++k) all |= subgroupBroadcast(x, k);
  return all;
}

float max_lanes(float x, uint count) {
  if (PERMUTED) {
    for (uint m = 1u; m < LANES; m <<= 1) {
      float y = subgroupShuffleXor(x, m);
      x = y > x ? y : x;
    }
    return x;
  }
  if (!IN_TURN) return subgroupMax(x);
  float most = -INFINITY;
  for (uint k = 0u; k < count; ++k) {
    float y = subgroupBroadcast(x, k);
    most = y > most ? y : most;
  }
  return most;
}

uint or_lanes(uint x) { return or_lanes(x, LANES); }
float max_lanes(float x) { return max_lanes(x, LANES); }

float sum_lanes(float x) {
  if (PERMUTED) {
    for (uint m = 1u; m < LANES; m <<= 1) x += subgroupShuffleXor(x, m);
    return x;
  }
  if (!IN_TURN) return subgroupAdd(x);
  float all = 0.0;
  for (uint k = 0u; k < LANES; ++k) all += subgroupBroadcast(x, k);
  return all;
}

float min_lanes(float x) { return -max_lanes(-x); }
vec3 max_lanes(vec3 x) { return vec3(max_lanes(x.x), max_lanes(x.y), max_lanes(x.z)); }
vec3 min_lanes(vec3 x) { return -max_lanes(-x); }
vec3 sum_lanes(vec3 x) { return vec3(sum_lanes(x.x), sum_lanes(x.y), sum_lanes(x.z)); }

// A bit per lane, of the first 32.
bool has_ballot() { return !PERMUTED && !IN_TURN; }
uint lanes_where(bool b, uint count) {
  return has_ballot() ? subgroupBallot(b).x : or_lanes(b ? 1u << gl_SubgroupInvocationID : 0u, count);
}
uint lanes_where(bool b) { return lanes_where(b, LANES); }
bool any_lane(bool b) { return has_ballot() ? subgroupBallot(b) != uvec4(0) : or_lanes(b ? 1u : 0u) != 0u; }
uint lanes_that(bool b) { return has_ballot() ? subgroupBallotBitCount(subgroupBallot(b)) : bitCount(lanes_where(b)); }
#endif
