// SPDX-License-Identifier: MIT
// Ray space in five dimensions (Arvo, Kirk 1987, R 3.1): x y z of the origin, u v of the direction on the face of the
// cube that it goes through, one such space a face. A ray's class is found by halving: which axis is halved depends on
// the cell alone (Simiakakis, Day 1994, R 3.2: adaptively), so that the sides taken make a key whose leading bits name
// the cells above.
#ifndef SHEAF_CLASSIFY_GLSL
#define SHEAF_CLASSIFY_GLSL
#include "scene/triangle.glsl"
#include "trace/cells/frustum.glsl"

struct Class {
  uint face;
  float place[5];
};

Class class_of(vec3 origin, vec3 direction) {
  uint face = face_of(direction), axis = face / 2u;
  vec3 o = permute(origin, axis), d = permute(direction, axis);
  vec2 slope = d.xy / d.z;
  return Class(face, float[5](o.x, o.y, o.z, slope.x, slope.y));
}

// A place that is not a number has no class of its own; such a ray meets nothing.
float number(float v) { return v == v ? v : 0.0; }
#endif
