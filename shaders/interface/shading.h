// SPDX-License-Identifier: MIT
// Constants of shading: what stops rays, how light is summed, the layers of a pixel.
#ifndef SHEAF_INTERFACE_SHADING_H
#define SHEAF_INTERFACE_SHADING_H
#include "interface/types.h"
SHEAF_INTERFACE_BEGIN

// Blended surfaces that a ray may go through on its way from the camera; what is further is not seen.
SHEAF_CONST MOST_BLENDED = 64u;

// What a dispatch's rays are to the sums of their pixels: several may be for one pixel, no two are, or every pixel has
// one and the sums do not matter yet.
SHEAF_CONST SUMS_SHARED = 0u, SUMS_OWN = 1u, SUMS_UNSET = 2u;

// Steps of the fixed-point optical depth in one stop (factor 2): 2^-13 stops of rounding a crossing.
SHEAF_CONST OPTICAL_STEP = 4096u;

// Surface layers of a pixel.
SHEAF_CONST LAYER_DEPTH = 0u;
SHEAF_CONST LAYER_NORMAL = 1u;
SHEAF_CONST LAYER_POSITION = 4u;
SHEAF_CONST LAYER_ALBEDO = 7u;
SHEAF_CONST LAYER_UV = 10u;
SHEAF_CONST LAYER_OBJECT = 12u;
SHEAF_CONST LAYER_MATERIAL = 13u;
SHEAF_CONST LAYER_WORDS = 14u;

SHEAF_INTERFACE_END
#endif
