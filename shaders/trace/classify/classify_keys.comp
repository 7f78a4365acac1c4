// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// Ray classification (R 3.1): face, then CLASS_HALVINGS times the half of the cell that the ray is in. Halved is the
// axis along which the cell's beam is widest: by the origins' extent, or by the directions' at the far end of the
// scene. Depth of the origins, along the beam, counts a quarter: it only moves where on their lines the rays begin.
//
// Before the sort keys go to slots, and again after it (`sorted`) they are read from there, which costs less than
// halving anew.
#define COMPUTE
#include "lib/common.glsl"
#include "interface/push/cells.h"
#include "lib/push.glsl"
#include "lists/rays.glsl"
#include "lib/counters.glsl"
#include "lib/curves.glsl"
#include "trace/classify/classify.glsl"
#include "scene/node.glsl"
#include "scene/hierarchy_box.glsl"
BUFFER(ROLE_KEYS, writeonly, uint, keys);
BUFFER(ROLE_RAY_CELLS, coherent, uint, slot_keys);  // no ray has a cell yet
BUFFER(ROLE_CLASS_BOUNDS, readonly, uint, class_bounds);
PUSH(ClassifyKeysPush);

uint key_of(Ray r) {
  Class c = class_of(r.origin, r.direction);
  vec3 scene_lo, scene_hi;
  hierarchy_box(scene_lo, scene_hi);
  vec3 size = permute(scene_hi - scene_lo, c.face / 2u);
  float weight[5] = float[5](1.0, 1.0, 0.25, size.z, size.z), lo[5], width[5];
  for (uint axis = 0u; axis < 5u; ++axis) {
    lo[axis] = unordered(class_bounds[10u * c.face + axis]);
    width[axis] = unordered(class_bounds[10u * c.face + 5u + axis]) - lo[axis];
  }
  uint key = c.face;
  [[dont_unroll]] for (uint n = 0u; n < CLASS_HALVINGS; ++n) {
    uint widest = 0u;
    float most = width[0] * weight[0];
    for (uint axis = 1u; axis < 5u; ++axis) {
      float wide = width[axis] * weight[axis];
      widest = wide > most ? axis : widest;
      most = max(most, wide);
    }
    uint upper = 0u;
    for (uint axis = 0u; axis < 5u; ++axis) {  // one of them: an array is not indexed by lane
      if (axis != widest) continue;
      width[axis] *= 0.5;
      upper = number(c.place[axis]) >= lo[axis] + width[axis] ? 1u : 0u;
      lo[axis] += upper != 0u ? width[axis] : 0.0;
    }
    key = (key << 1) | upper;
  }
  return key;
}

void main() {
  uint i = global_index();
  if (i >= counters[COUNT_RAYS + push.kind]) return;
  uint slot = load_slot(ray_list.order, i);
  if (push.sorted == 0u) slot_keys[slot] = key_of(load_ray(ray_list.rays, slot));
  keys[i] = slot_keys[slot];
}
