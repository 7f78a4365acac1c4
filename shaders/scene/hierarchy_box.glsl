// SPDX-License-Identifier: MIT
// The box of the whole object hierarchy: the union of the root's children. lo > hi where there is nothing.
#ifndef SHEAF_HIERARCHY_BOX_GLSL
#define SHEAF_HIERARCHY_BOX_GLSL
#include "scene/node.glsl"
#include "lib/common.glsl"
#include "scene/node_boxes.glsl"

void hierarchy_box(out vec3 lo, out vec3 hi) {
  Boxes boxes = load_boxes(0u);
  lo = vec3(INFINITY);
  hi = vec3(-INFINITY);
  for (uint c = 0u; c < WIDE; ++c) {
    if ((boxes.grid.present & (1u << c)) == 0u) continue;
    vec3 child_lo, child_hi;
    child_box(boxes, c, child_lo, child_hi);
    lo = min(lo, child_lo);
    hi = max(hi, child_hi);
  }
}
#endif
