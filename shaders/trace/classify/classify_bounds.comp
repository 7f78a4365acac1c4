// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// Bounding volumes of R 3.1, of the rays there are: their least and greatest places along the five axes, a face each. A
// subgroup takes the faces of its rays one after the other (most have but one), and asks for the atomics only where a
// bound moves.
#define COMPUTE
#include "lib/common.glsl"
#include "interface/push/lists.h"
#include "lib/push.glsl"
#include "lists/rays.glsl"
#include "lib/counters.glsl"
#include "lib/curves.glsl"
#include "trace/classify/classify.glsl"
#include "lib/lanes.glsl"
BUFFER(ROLE_CLASS_BOUNDS, coherent, uint, class_bounds);  // ordered integers: five least, five greatest a face
PUSH(BoundsPush);

const uint NO_FACE = 6u;

void bound(uint face, uint axis, float least, float most) {
  least = min_lanes(least);
  most = max_lanes(most);
  uint at = 10u * face + axis;
  if (!subgroupElect()) return;
  if (ordered(least) < class_bounds[at]) atomicMin(class_bounds[at], ordered(least));
  if (ordered(most) > class_bounds[at + 5u]) atomicMax(class_bounds[at + 5u], ordered(most));
}

void bound_faces(bool left, Class c) {
  for (;;) {
    uint face = uint(min_lanes(left ? float(c.face) : float(NO_FACE)));
    if (face == NO_FACE) return;
    bool mine = left && c.face == face;
    left = left && !mine;
    [[unroll]] for (uint axis = 0u; axis < 5u; ++axis) {
      float place = number(c.place[axis]);
      bound(face, axis, mine ? place : INFINITY, mine ? place : -INFINITY);
    }
  }
}

void main() {
  uint lane = gl_SubgroupInvocationID;
  if (push.reset != 0u) {
    for (uint i = lane; i < 60u; i += LANES) class_bounds[i] = i % 10u < 5u ? 0xFFFFFFFFu : 0u;
    return;
  }
  uint count = counters[COUNT_RAYS + push.kind], first = global_group() * GROUP, last = min(first + GROUP, count);
  [[dont_unroll]] for (uint base = first; base < last; base += LANES) {
    Ray r = load_ray(ray_list.rays, load_slot(ray_list.order, min(base + lane, last - 1u)));
    bound_faces(base + lane < last, class_of(r.origin, r.direction));
  }
}
