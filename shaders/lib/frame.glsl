// SPDX-License-Identifier: MIT
// What holds for the frame and the batch of samples.
#ifndef SHEAF_LIB_FRAME_GLSL
#define SHEAF_LIB_FRAME_GLSL
#include "interface/bindings.h"
#include "interface/frame.h"
layout(scalar, set = 0, binding = ROLE_FRAME) readonly buffer Block_frame { Frame frame; };
#endif
