// SPDX-License-Identifier: MIT
// What skins and morph targets do to an instance.
#ifndef SHEAF_INTERFACE_DEFORM_H
#define SHEAF_INTERFACE_DEFORM_H
#include "interface/types.h"
SHEAF_INTERFACE_BEGIN

struct Deform {     // one deforming instance's vertices
  uint first_vertex;     // static, object space
  uint vertex_count;
  uint dynamic;
  uint joint_words;      // offset into the joint index/weight buffer, NO_INDEX: not skinned
  uint first_matrix;     // 3x4 matrices, of this instance's skin
  uint morph_first;      // vec3 offset of the first target's positions
  uint morph_targets;
  uint weight_first;
  uint tangent;
  uint instance;
  uint morph_normals;    // vec3 offset of the first target's normals, NO_INDEX: none
  uint morph_tangents;
  uint flat_faces;       // not 0: its normals are those of its deformed triangles, written as 0
  uint uv_from[2];       // where texture coordinates or colors are morphed: from the mesh's own place in their buffer
  uint uv_to[2];         // to the instance's, …
  uint uv_morphs[2];     // … by deltas: vec3 offset of the first target's (u, v, 0), NO_INDEX: none
  uint color_from;
  uint color_to;
  uint color_morphs;     // r, g, b
  uint alpha_morphs;     // (a, 0, 0)
  // Of flat faces with tangents: vec3 offset of (a, b, 0) a triangle, see Mesh::face_tangents; else NO_INDEX.
  uint face_tangents;
};

SHEAF_INTERFACE_END
#endif
