// SPDX-License-Identifier: MIT
// Reading triangles, instances and materials.
#include "memory.glsl"
#include "triangle.glsl"
BUFFER(ROLE_INSTANCES, readonly, Instance, instances);
BUFFER(ROLE_MATERIALS, readonly, Material, materials);

uint instance_of(Corners corners) { return corners.instance & TRIANGLE_INSTANCE_MASK; }

TriangleHit intersect_corners(Shear s, Corners v, float tmin, float tmax) {
  return intersect_triangle(s, v.a, v.b, v.c, frame.box_pad, tmin, tmax);
}
