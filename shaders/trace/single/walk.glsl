// SPDX-License-Identifier: MIT
// Where a ray's walk through the object hierarchy stands, and what it has tested.
#ifndef SHEAF_WALK_GLSL
#define SHEAF_WALK_GLSL
#include "trace/common/visit.glsl"

struct Tests {
  uint boxes;
  uint triangles;
};

// In place of a child: take the next from the stack (no leaf reads so: it would end past 2^27).
const uint NEXT = 0xFFFFFFFEu;

struct Walk {
  uint current;  // a node, the rest of a leaf, NEXT, or CHILD_EMPTY: done
  Visit visit;
};
#endif
