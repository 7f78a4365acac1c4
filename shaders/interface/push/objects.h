// SPDX-License-Identifier: MIT
// Push constants: objects, and the dump of triangles.
#ifndef SHEAF_PUSH_OBJECTS_H
#define SHEAF_PUSH_OBJECTS_H
#include "interface/push/push.h"
SHEAF_INTERFACE_BEGIN

// objects_refit
struct RefitPush {
  uint first;  // of the nodes of this height
  uint count;
};
SHEAF_PUSH(RefitPush, 2)

// objects_spheres
struct SpheresPush {
  uint runs;  // not 0: of so many runs, one per invocation, instead of the triangles
};
SHEAF_PUSH(SpheresPush, 1)

// dump_triangles
struct DumpTrianglesPush {
  DeviceAddress to;
  uint first;
  uint count;
};
SHEAF_PUSH(DumpTrianglesPush, 4)

SHEAF_INTERFACE_END
#endif
