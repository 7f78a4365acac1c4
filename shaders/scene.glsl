// SPDX-License-Identifier: MIT
// Reading triangles.
#include "memory.glsl"
#include "triangle.glsl"

uint instance_of(Corners corners) { return corners.instance & TRIANGLE_INSTANCE_MASK; }

TriangleHit intersect_corners(Shear s, Corners v, float tmin, float tmax) {
  return intersect_triangle(s, v.a, v.b, v.c, frame.box_pad, tmin, tmax);
}
