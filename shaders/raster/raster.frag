// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// The rasteriser finds which triangles cover a sample; which is nearest is decided by the same t and the same tie as
// for traced rays, in one 64-bit minimum. Interpolated depth would disagree with the ray tracer on coplanar and distant
// faces.
#include "lib/common.glsl"
#include "lists/rays.glsl"
#include "scene/scene.glsl"
#include "raster/camera.glsl"
#include "scene/attributes.glsl"
layout(constant_id = SPEC_MASKED) const bool MASKED = true;
// Bound, not by address: a fragment's 64-bit minimum by address made the pass a third dearer on a CPU device.
BUFFER(ROLE_VISIBILITY, coherent, uint64_t, visibility);
layout(location = 0) flat in uint triangle;
layout(location = 1) flat in vec3 corner_a;
layout(location = 2) flat in vec3 corner_b;
layout(location = 3) flat in vec3 corner_c;
layout(location = 4) flat in uint word;

void main() {
  uvec2 at = to_uint(gl_FragCoord.xy - 0.5);  // of pixel centres
  Ray ray = camera_ray(frame.tile_x + at.x, frame.tile_y + at.y, frame.place);
  TriangleHit h = project_to_triangle(make_shear(ray.origin, ray.direction), corner_a, corner_b, corner_c, 0.0);
  if (!(h.t >= ray.tmin && h.t <= ray.tmax) || is_hidden(word, h.clockwise)) return;
  if (RANKED) h.t += rank_shift(make_shear(ray.origin, ray.direction), Corners(corner_a, corner_b, corner_c, word), h);
  if (!(h.t <= ray.tmax)) return;
  uint64_t found = (uint64_t(floatBitsToUint(h.t)) << 32) | uint64_t(triangle);
  uint pixel = at.y * frame.tile_width + at.x;
  if (found >= visibility[pixel]) return;  // only ever falls: a stale value costs an atomic, nothing else
  if (MASKED && masked_out(triangle, h.barycentric)) return;
  atomicMin(visibility[pixel], found);
}
