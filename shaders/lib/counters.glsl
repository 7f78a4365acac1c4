// SPDX-License-Identifier: MIT
#ifndef SHEAF_COUNTERS_GLSL
#define SHEAF_COUNTERS_GLSL
#include "lib/common.glsl"
#include "interface/counters.h"
BUFFER(ROLE_COUNTERS, coherent, uint, counters);
#endif
