// SPDX-License-Identifier: MIT
// The matrix of a skinned vertex (glTF 2.0, 3.7.3.3), relative to the frame origin.
#ifndef SHEAF_SKIN_GLSL
#define SHEAF_SKIN_GLSL
#include "lib/common.glsl"
#include "interface/deform.h"
BUFFER(ROLE_JOINTS, readonly, uint, joints);
BUFFER(ROLE_JOINT_MATRICES, readonly, vec4, joint_rows);  // three rows a matrix

struct Rows {
  vec4 r0, r1, r2;
};

Rows blended_matrix(Deform d, uint v) {
  Rows m = Rows(vec4(0), vec4(0), vec4(0));
  uint at = d.joint_words + 12u * v;
  for (uint k = 0u; k < 8u; ++k) {
    float weight = uintBitsToFloat(joints[at + 4u + k]);
    if (weight == 0.0) continue;
    uint joint = (joints[at + k / 2u] >> (16u * (k % 2u))) & 0xFFFFu;
    uint row = 3u * (d.first_matrix + joint);
    m.r0 += weight * joint_rows[row];
    m.r1 += weight * joint_rows[row + 1u];
    m.r2 += weight * joint_rows[row + 2u];
  }
  return m;
}
#endif
