// SPDX-License-Identifier: MIT
// Declares a kernel's push constants: its struct (interface/push), and what Recorder::bind_list was given last.
#ifndef SHEAF_LIB_PUSH_GLSL
#define SHEAF_LIB_PUSH_GLSL
#include "interface/bindings.h"
#include "interface/rays.h"
#define PUSH(type)                                    \
  layout(push_constant, scalar) uniform Block_push {  \
    type push;                                        \
    layout(offset = PUSH_LISTS) ListAddresses ray_list; \
  }
#endif
