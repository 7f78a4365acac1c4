// SPDX-License-Identifier: MIT
// Reading triangles.
#include "memory.glsl"
#include "triangle.glsl"

// The sign that turns (b − a) × (c − a) to the front: of the instance's matrix, or of the triangle's own skinning matrices.
float front_sign(Instance i, Corners corners) {
  return uintBitsToFloat(floatBitsToUint(i.determinant_sign) ^ ((corners.instance & TRIANGLE_MIRRORED) << 2));
}

uint instance_of(Corners corners) { return corners.instance & TRIANGLE_INSTANCE_MASK; }

TriangleHit intersect_corners(Shear s, Corners v, float tmin, float tmax) {
  return intersect_triangle(s, v.a, v.b, v.c, frame.box_pad, tmin, tmax);
}
