// SPDX-License-Identifier: MIT
// Reading triangles, instances and materials.
#include "triangle.glsl"
BUFFER(ROLE_TRIANGLE_A, readonly, vec3, triangle_a);
BUFFER(ROLE_TRIANGLE_B, readonly, vec3, triangle_b);
BUFFER(ROLE_TRIANGLE_C, readonly, vec3, triangle_c);
BUFFER(ROLE_TRIANGLE_INSTANCE, readonly, uint, triangle_instance);
BUFFER(ROLE_INSTANCES, readonly, Instance, instances);
BUFFER(ROLE_MATERIALS, readonly, Material, materials);

uint instance_of(uint triangle) { return triangle_instance[triangle] & TRIANGLE_INSTANCE_MASK; }

TriangleHit intersect_scene_triangle(Shear s, uint triangle, float tmin, float tmax) {
  return intersect_triangle(s, triangle_a[triangle], triangle_b[triangle], triangle_c[triangle], frame.box_pad, tmin, tmax);
}
