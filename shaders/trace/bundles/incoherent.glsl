// SPDX-License-Identifier: MIT
// Bundles whose rays go one a lane, in any order.
#ifndef SHEAF_INCOHERENT_GLSL
#define SHEAF_INCOHERENT_GLSL

void fall_back_to_single_rays(uint bundle) {
  uint before = atomicAdd(counters[COUNT_INCOHERENT], 1u);
  work[before] = bundle;
  raise_args(ARGS_INCOHERENT, before + 1u);
}
#endif
