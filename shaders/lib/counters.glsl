// SPDX-License-Identifier: MIT
#ifndef SHEAF_COUNTERS_GLSL
#define SHEAF_COUNTERS_GLSL
BUFFER(ROLE_COUNTERS, coherent, uint, counters);
#endif
