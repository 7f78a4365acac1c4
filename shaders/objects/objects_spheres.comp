// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// Bounding spheres of the triangles that moved, and of runs of them: whole instances (C: mesh spheres) and parts of
// these. Padded by PAD of the radius for its own rounding and by twice box_pad, which covers what the edge functions
// may add to a triangle (triangle.glsl).
#define COMPUTE
#include "lib/common.glsl"
#include "interface/push/objects.h"
#include "lib/push.glsl"
#include "lists/rays.glsl"
#include "scene/memory.glsl"
#include "trace/common/ray_node.glsl"
BUFFER(ROLE_SPHERES, coherent, vec4, spheres);
BUFFER(ROLE_RUNS, readonly, uvec2, runs);  // first triangle, how many
PUSH(SpheresPush);

vec4 padded(vec3 centre, float radius) { return vec4(centre, radius * (1.0 + PAD) + 2.0 * frame.box_pad); }

vec4 triangle_sphere(vec3 a, vec3 b, vec3 c) {
  // The smallest: the longest side's where the angle across is not acute, else the circumscribed one.
  vec3 ab = b - a, ac = c - a, bc = c - b;
  float lab = dot(ab, ab), lac = dot(ac, ac), lbc = dot(bc, bc);
  vec3 centre;
  if (lab >= lac + lbc) {
    centre = 0.5 * (a + b);
  } else if (lac >= lab + lbc) {
    centre = 0.5 * (a + c);
  } else if (lbc >= lab + lac) {
    centre = 0.5 * (b + c);
  } else {
    vec3 n = cross(ab, ac);
    centre = a + (lac * cross(n, ab) + lab * cross(ac, n)) / (2.0 * dot(n, n));
    if (!(length(centre - a) < INFINITY)) centre = (a + b + c) / 3.0;
  }
  return vec4(centre, max(max(length(a - centre), length(b - centre)), length(c - centre)));
}

void main() {
  uint i = global_index();
  if (push.runs == 0u) {
    if (i >= frame.triangles) return;
    Corners v = load_triangle(i);
    vec4 s = triangle_sphere(v.a, v.b, v.c);
    spheres[i] = padded(s.xyz, s.w);
    return;
  }
  if (i >= push.runs) return;
  uint first = runs[i].x, last = first + runs[i].y;
  vec3 lo = vec3(INFINITY), hi = vec3(-INFINITY);
  for (uint t = first; t < last; ++t) {
    Corners v = load_triangle(t);
    lo = min(lo, min(min(v.a, v.b), v.c));
    hi = max(hi, max(max(v.a, v.b), v.c));
  }
  vec3 centre = 0.5 * lo + 0.5 * hi;
  float radius = 0.0;
  for (uint t = first; t < last; ++t) {
    Corners v = load_triangle(t);
    radius = max(radius, max(max(length(v.a - centre), length(v.b - centre)), length(v.c - centre)));
  }
  spheres[i] = padded(centre, radius);
}
