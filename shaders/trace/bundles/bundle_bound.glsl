// SPDX-License-Identifier: MIT
// The node over a bundle (R 4.3): bounded at once from the boxes of its rays' origins and directions, tighter than
// unions of unions.
#ifndef SHEAF_BUNDLE_BOUND_GLSL
#define SHEAF_BUNDLE_BOUND_GLSL
#include "trace/common/ray_node.glsl"

struct Spread {
  vec3 olo, ohi;       // of origins
  vec3 dlo, dhi, sum;  // of directions
  float tmax;
};

RayNode bundle_bound(Spread s) {
  vec3 centre = 0.5 * s.olo + 0.5 * s.ohi;
  float size = length(s.sum);
  vec3 axis = size > 1e-3 ? s.sum / size : vec3(0, 0, 1);
  // Unit vectors all: |d − axis| bounds the chord, and the angle is 2·asin(chord/2).
  float chord = length(max(abs(s.dlo - axis), abs(s.dhi - axis)));
  float angle = size > 1e-3 && chord < 1.4 ? 2.0 * arc(0.5 * chord, sqrt(1.0 - 0.25 * chord * chord)) : 4.0;
  float radius =
      length(0.5 * (s.ohi - s.olo)) * (1.0 + PAD) + PAD * max(max(abs(centre.x), abs(centre.y)), abs(centre.z)) + LEAST;
  return RayNode(centre, s.ohi != s.olo ? radius : 0.0, axis, angle * (1.0 + PAD) + PAD, s.tmax);
}

// Too wide, past a half-angle of `widest`, to be walked as one. A direction component that changes sign leaves its slab
// without bounds: such a bundle would walk half the scene.
bool is_incoherent(RayNode node, Spread s, float widest) {
  vec3 signs = s.dlo * s.dhi;
  return node.angle > widest || (min(min(signs.x, signs.y), signs.z) < 0.0 && node.angle > 0.25 * widest);
}
#endif
