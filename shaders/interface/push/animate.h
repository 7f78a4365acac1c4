// SPDX-License-Identifier: MIT
// Push constants: animate.
#ifndef SHEAF_PUSH_ANIMATE_H
#define SHEAF_PUSH_ANIMATE_H
#include "interface/push/push.h"
SHEAF_INTERFACE_BEGIN

// animate_vertices, animate_triangles
struct AnimatePush {
  uint blocks;
};
SHEAF_PUSH(AnimatePush, 1)

SHEAF_INTERFACE_END
#endif
