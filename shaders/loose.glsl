// SPDX-License-Identifier: MIT
// Bundles whose rays go one a lane, in any order.
const float LOOSE_ANGLE = 8.0;  // added to that of a bundle's cone: not to be walked as one

void goes_alone(uint bundle) {
  uint before = atomicAdd(counters[COUNT_LOOSE], 1u);
  work[before] = bundle;
  raise_args(ARGS_LOOSE, before + 1u);
}
