// SPDX-License-Identifier: MIT
// Counts of tests: 64-bit sums per kind, and (for the `tests` layer) a sum per pixel. Without COUNTED they cost
// nothing.
#ifndef SHEAF_COUNTING_GLSL
#define SHEAF_COUNTING_GLSL
#include "lib/common.glsl"
#include "interface/counters.h"
#extension GL_KHR_shader_subgroup_arithmetic : require
layout(constant_id = SPEC_COUNTED) const bool COUNTED = false;
layout(constant_id = SPEC_PIXEL_COUNTED) const bool PIXEL_COUNTED = false;
BUFFER(ROLE_STATS, coherent, uint64_t, stats);
BUFFER(ROLE_PIXEL_TESTS, coherent, uint, pixel_tests);

void count_tests(uint kind, uint field, uint amount) {
  if (!COUNTED) return;
  uint sum = subgroupAdd(amount);
  if (subgroupElect() && sum != 0u) atomicAdd(stats[kind * STAT_FIELDS + field], uint64_t(sum));
}

void count_pixel(uint pixel, uint amount) {
  if (PIXEL_COUNTED && amount != 0u) atomicAdd(pixel_tests[pixel], amount);
}
#endif
