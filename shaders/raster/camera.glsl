// SPDX-License-Identifier: MIT
// The camera's ray through a place in a pixel, the same bits in the raster pass and in generate (SHADING.md, Samples).
#ifndef SHEAF_CAMERA_GLSL
#define SHEAF_CAMERA_GLSL
#include "lists/rays.glsl"
#include "lib/frame.glsl"
Ray camera_ray(uint x, uint y, vec2 place) {
  precise float sx = 2.0 * ((float(x) + place.x) / float(frame.width)) - 1.0;
  precise float sy = 1.0 - 2.0 * ((float(y) + place.y) / float(frame.height));
  precise vec3 across = frame.right * sx + frame.up * sy;
  Ray ray;
  if (frame.orthographic != 0u) {
    precise vec3 origin = frame.eye + across;
    ray.origin = origin;
    ray.direction = frame.forward;
    ray.tmin = frame.near;
    ray.tmax = frame.far;
  } else {
    precise vec3 direction = across + frame.forward;
    precise float size = sqrt(direction.x * direction.x + direction.y * direction.y + direction.z * direction.z);
    ray.origin = frame.eye;
    precise vec3 unit = direction / size;
    ray.direction = unit;
    // Forward is a unit vector, and right and up are perpendicular to it: t is |direction| per unit of depth.
    ray.tmin = frame.near * size;
    ray.tmax = frame.far * size;
  }
  return ray;
}
#endif
