// SPDX-License-Identifier: MIT
// How a dispatch's work is distributed over the threads of a CPU device. llvmpipe gives each of its threads the same
// number of consecutive workgroups. If a group's number were its place in the list, the first of two threads would have
// the upper half of the picture and would wait for the one that has the lower half. Read by GLSL and C++.
#ifndef SHEAF_REMAP_WORKGROUP_H
#define SHEAF_REMAP_WORKGROUP_H
#ifdef __cplusplus
#include <cmath>
#include <cstdint>
namespace sheaf::gpu {
using uint = std::uint32_t;
using std::floor;
inline uint to_uint(float v) { return static_cast<uint>(v); }
#define SHEAF_FUNCTION inline
#else
#include "lib/convert.glsl"
#define SHEAF_FUNCTION
#endif

// Which of `groups` pieces of work the group does: a permutation that gives them to `workers` threads by turns. A turn
// is 1 << longest pieces, or fewer where that makes less than eight turns: short turns are more even, long ones share
// fewer cache lines.
SHEAF_FUNCTION uint remap_workgroup(uint group, uint groups, uint workers, uint longest) {
  uint each = groups / workers;
  // The quotient below is half a group or more off a whole number, and two roundings off the true one: less, up to 2^21
  // groups.
  if (group >= each * workers || groups > (1u << 21)) return group;
  uint worker = to_uint(floor((float(int(group)) + 0.5f) / float(int(each))));
  uint order = 0u;
  for (uint k = 1u; k <= longest; ++k) order += uint(each >= (8u << k));
  uint place = group - worker * each, turns = each >> order, in_turns = turns << order;
  uint left = worker * (each - in_turns) + (place - in_turns);
  return place < in_turns ? ((((place >> order) * workers + worker) << order) | (place & ((1u << order) - 1u)))
                          : in_turns * workers + left;
}

#ifdef __cplusplus
}  // namespace sheaf::gpu
#endif
#endif
