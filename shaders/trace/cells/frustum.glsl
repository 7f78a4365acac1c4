// SPDX-License-Identifier: MIT
// A packet's frustum (S, R 3.4): its rays share a dominant axis z and the way they go along it; two rectangles across
// z, one where the first ray begins and one where the last can end, hold the places at which the rays' lines cross
// these planes. Between the planes a line's place is a mean of its two places, so it lies within the same mean of the
// rectangles: also where rays meet (shadow rays turned round: the near rectangle is their light) or part.
//
// Padding. u = 2^-24, M the greatest coordinate of origins and scene. What must not be culled is a box of which some
// ray of the packet passes the slab test (triangle.glsl) at a t within its limits; the corresponding real point of the
// ray's line is within
//   e = 6.1 uM of the box: plane − origin, its product with the reciprocal and the reciprocal are rounded,
//   |plane − origin| ≤ 2M.
// Against it stand, in uM: a place on a plane is rounded 4 times at up to 3M (9), the padded rectangle once (3); the
// box's plane along z may be e off, and slopes are at most 1 (6.1); so may the quotient for z, rounded 3 times at up to
// 4M (12); quotients for the rectangles' sides are rounded 4 times, of differences of up to 4M (16.4); sides moved from
// parallel to z by 2^-30 M (0.1). With e itself 52.7 uM; FRUSTUM_PAD is 64 u. The planes are moved out by as much,
// which covers e, limits rounded (2) and the quotient for z.
#ifndef SHEAF_FRUSTUM_GLSL
#define SHEAF_FRUSTUM_GLSL
#include "lib/common.glsl"
#include "scene/triangle.glsl"

const float FRUSTUM_PAD = 3.8146973e-6;  // 2^-18

struct Frustum {
  float plane;     // along z; 0 there, 1 on the far plane
  float inverse;   // of the planes' distance, negative where rays go down z
  uint axis;       // z
  uint octant;     // of the directions, roughly
  bool endless;    // coordinates past what floats can be padded for: everything is met
  bool settled;    // of a cell that was not divided: what has met it meets it again
  vec4 side;       // on the near plane: u lower, u upper, v lower, v upper
  vec4 reciprocal; // of what each moves by until the far plane; finite, not 0
};

uint face_of(vec3 d) {  // dominant axis and sign: six of them
  vec3 a = abs(d);
  uint axis = a.x >= a.y && a.x >= a.z ? 0u : a.y >= a.z ? 1u : 2u;
  return 2u * axis + (d[axis] < 0.0 ? 1u : 0u);
}

// Whether some ray of the packet may enter the box, whose coordinates are permuted: z last.
bool frustum_enters(Frustum f, vec3 lo, vec3 hi) {
  float low = (lo.z - f.plane) * f.inverse, high = (hi.z - f.plane) * f.inverse;
  float first = max(min(low, high), 0.0), last = min(max(low, high), 1.0);
  // The lower side of u is below hi.x, its upper side above lo.x; likewise v. Each bounds the way s from plane to
  // plane.
  vec4 s = (vec4(hi.x, lo.x, hi.y, lo.y) - f.side) * f.reciprocal;
  bvec4 moves_out = greaterThan(f.reciprocal, vec4(0));  // the side grows with s
  last = min(last, min(moves_out.x ? s.x : INFINITY, moves_out.y ? INFINITY : s.y));
  last = min(last, min(moves_out.z ? s.z : INFINITY, moves_out.w ? INFINITY : s.w));
  first = max(first, max(moves_out.x ? -INFINITY : s.x, moves_out.y ? s.y : -INFINITY));
  first = max(first, max(moves_out.z ? -INFINITY : s.z, moves_out.w ? s.w : -INFINITY));
  return first <= last || f.endless;
}

// A frustum under construction: z as it grows along the rays.
struct Hull {
  uint axis;
  float sign;
  float first, last;  // where rays begin and end
  float largest;      // M
  vec3 lo, hi;        // the scene, permuted
  vec4 near, far;     // sides on the planes, as in Frustum
};

Hull begin_hull(vec3 direction, vec3 lo, vec3 hi) {
  Hull h;
  uint face = face_of(direction);
  h.axis = face / 2u;
  h.sign = (face & 1u) != 0u ? -1.0 : 1.0;
  h.first = INFINITY;
  h.last = -INFINITY;
  vec3 most = max(abs(lo), abs(hi));
  h.largest = max(max(most.x, most.y), most.z);
  h.lo = permute(lo, h.axis);
  h.hi = permute(hi, h.axis);
  h.near = h.far = vec4(INFINITY, -INFINITY, INFINITY, -INFINITY);
  return h;
}

// First every ray's extent, then the planes, then every ray's places on them. Comparisons leave out what is not a
// number.
void add_extent(inout Hull h, vec3 origin, vec3 direction, float tmin, float tmax) {
  float z = permute(origin, h.axis).z, d = permute(direction, h.axis).z;
  float begin = h.sign * (z + tmin * d), end = h.sign * (z + tmax * d);
  h.first = begin < h.first ? begin : h.first;
  h.last = end > h.last ? end : h.last;
  vec3 a = abs(origin);
  float most = max(max(a.x, a.y), a.z);
  h.largest = most > h.largest ? most : h.largest;
}

// No hit lies outside the scene.
void set_planes(inout Hull h) {
  float lowest = h.sign > 0.0 ? h.lo.z : -h.hi.z, highest = h.sign > 0.0 ? h.hi.z : -h.lo.z,
        pad = FRUSTUM_PAD * h.largest;
  h.first = clamp(h.first, lowest, highest);
  h.last = clamp(h.last, h.first, highest);
  h.first = h.sign * (h.first - pad);
  h.last = h.sign * (h.last + pad);
}

void add_places(inout Hull h, vec3 origin, vec3 direction) {
  vec3 o = permute(origin, h.axis), d = permute(direction, h.axis);
  vec2 slope = d.xy / d.z, near = o.xy + (h.first - o.z) * slope, far = o.xy + (h.last - o.z) * slope;
  vec4 on_near = near.xxyy, on_far = far.xxyy;
  bvec4 upper = bvec4(false, true, false, true);
  h.near =
      mix(mix(h.near, on_near, lessThan(on_near, h.near)), mix(h.near, on_near, greaterThan(on_near, h.near)), upper);
  h.far = mix(mix(h.far, on_far, lessThan(on_far, h.far)), mix(h.far, on_far, greaterThan(on_far, h.far)), upper);
}

Frustum end_hull(Hull h, uint octant) {
  Frustum f;
  float pad = FRUSTUM_PAD * h.largest;
  vec4 out_by = vec4(-pad, pad, -pad, pad);
  f.plane = h.first;
  f.inverse = 1.0 / (h.last - h.first);
  f.axis = h.axis;
  f.octant = octant;
  f.endless = !(h.largest < 1e30);
  f.settled = false;
  f.side = h.near + out_by;
  vec4 moved = (h.far + out_by) - f.side;
  float least = max(h.largest * 9.3132257e-10, 1e-36);  // 2^-30: a side along z is turned a little
  moved = mix(moved, vec4(least), lessThan(abs(moved), vec4(least)));
  f.reciprocal = 1.0 / moved;
  return f;
}
#endif
