// SPDX-License-Identifier: MIT
// Push constants: generate, shade and resolve.
#ifndef SHEAF_PUSH_SHADE_H
#define SHEAF_PUSH_SHADE_H
#include "interface/push/push.h"
SHEAF_INTERFACE_BEGIN

// generate_begin
struct GenerateBeginPush {
  uint primary;
  uint direct;  // 1: the camera's rays are not written before
};
SHEAF_PUSH(GenerateBeginPush, 2)

// generate
struct GeneratePush {
  uint kind;  // of the parents
  uint direct;  // 1: the parents are the camera's rays, and were not written: raster knows what they hit
  uint sums;  // SUMS_…, of the pixels
};
SHEAF_PUSH(GeneratePush, 3)

// shade
struct ShadePush {
  uint kind;  // of the parents
  uint sums;  // SUMS_…, of the pixels
};
SHEAF_PUSH(ShadePush, 2)

// resolve
struct ResolvePush {
  DeviceAddress output_at;
  float inverse_samples;
};
SHEAF_PUSH(ResolvePush, 3)

SHEAF_INTERFACE_END
#endif
