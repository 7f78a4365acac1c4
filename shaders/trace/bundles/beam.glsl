// SPDX-License-Identifier: MIT
// Slabs of a bundle of rays: interval arithmetic over the very operations of each ray's own slab test (subtraction and
// multiplication, monotone under rounding), so that no box is missed that one of its rays enters.
#ifndef SHEAF_BEAM_GLSL
#define SHEAF_BEAM_GLSL
#include "lib/common.glsl"
#include "scene/triangle.glsl"

struct Beam {
  vec3 near_origin, far_origin;  // a coordinate: the origin from which a box's near (far) plane is reached first (last)
  vec3 ilo, ihi;                 // inverse directions
  float tmin, farthest;
};

struct Extent {
  vec3 olo, ohi, ilo, ihi;
  float tmin;
};

bvec3 backwards(vec3 ilo) { return lessThan(ilo, vec3(0)); }

Beam make_beam(Extent e, float farthest) {
  bvec3 back = backwards(e.ilo);
  return Beam(mix(e.ohi, e.olo, back), mix(e.olo, e.ohi, back), e.ilo, e.ihi, e.tmin, farthest);
}

// Whether some ray of the beam may enter the box.
bool beam_enters(Beam b, vec3 lo, vec3 hi) {
  bvec3 back = backwards(b.ilo);
  precise vec3 near = mix(lo, hi, back) - b.near_origin, far = mix(hi, lo, back) - b.far_origin;
  precise vec3 entry = near * mix(b.ihi, b.ilo, greaterThanEqual(near, vec3(0)));
  precise vec3 leave = far * mix(b.ilo, b.ihi, greaterThanEqual(far, vec3(0)));
  // An axis along which the rays go both ways bounds nothing.
  bvec3 mixed = bvec3(back.x && b.ihi.x > 0.0, back.y && b.ihi.y > 0.0, back.z && b.ihi.z > 0.0);
  float first = greatest(mix(entry, vec3(-INFINITY), mixed)), last = least(mix(leave, vec3(INFINITY), mixed));
  return first <= last && last >= b.tmin && first <= b.farthest;
}
#endif
