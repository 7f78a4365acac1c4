// SPDX-License-Identifier: MIT
// Bundles whose rays go one a lane, in any order.
#ifndef SHEAF_INCOHERENT_GLSL
#define SHEAF_INCOHERENT_GLSL
#include "lib/args.glsl"
#include "lib/counters.glsl"

BUFFER(ROLE_INCOHERENT_BUNDLES, writeonly, uint, incoherent_bundles);

void fall_back_to_single_rays(uint bundle) {
  uint before = atomicAdd(counters[COUNT_INCOHERENT], 1u);
  incoherent_bundles[before] = bundle;
  raise_args(ARGS_INCOHERENT, before + 1u);
}
#endif
