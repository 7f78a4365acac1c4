// SPDX-License-Identifier: MIT
// Bundles whose rays go one a lane, in any order.
#ifndef SHEAF_INCOHERENT_GLSL
#define SHEAF_INCOHERENT_GLSL

void goes_alone(uint bundle) {
  uint before = atomicAdd(counters[COUNT_LOOSE], 1u);
  work[before] = bundle;
  raise_args(ARGS_LOOSE, before + 1u);
}
#endif
