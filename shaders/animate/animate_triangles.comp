// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// World-space triangles of the instances that moved, relative to the frame origin. A workgroup takes one block of up to
// GROUP triangles of one instance.
#define COMPUTE
#include "lib/common.glsl"
#include "interface/push/animate.h"
#include "lib/push.glsl"
#include "lists/rays.glsl"
#include "scene/memory.glsl"
#include "animate/skin.glsl"
#include "lib/unit.glsl"
layout(constant_id = SPEC_MIRRORED_SKINS) const bool MIRRORED_SKINS = false;  // some skin may have a joint that mirrors
layout(buffer_reference, scalar, buffer_reference_align = 8) writeonly buffer Triangles { Corners triangle[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer TriangleWords { uint word[]; };
BUFFER(ROLE_INSTANCES, readonly, Instance, instances);
BUFFER(ROLE_MATERIALS, readonly, Material, materials);
BUFFER(ROLE_DEFORM, readonly, Deform, deforms);
BUFFER(ROLE_ANIMATE_BLOCKS, readonly, uvec2, work);  // (instance, first triangle within it)
PUSH(AnimatePush);

float size_of(Rows m) { return max_of(max(max(abs(m.r0.xyz), abs(m.r1.xyz)), abs(m.r2.xyz))); }

float determinant_of(Rows m, float scale) { return dot(scale * m.r0.xyz, cross(scale * m.r1.xyz, scale * m.r2.xyz)); }

bool mirrored(Instance i, uint t) {
  uint deform = i.marks & INSTANCE_DEFORM;
  if (!MIRRORED_SKINS || deform == INSTANCE_DEFORM) return false;
  Deform d = deforms[deform];
  uvec3 v = triangle_vertices(i, t);
  Rows a = blended_matrix(d, v.x), b = blended_matrix(d, v.y), c = blended_matrix(d, v.z);
  float scale = inverse_scale(max(size_of(a), max(size_of(b), size_of(c))));
  return determinant_of(a, scale) + determinant_of(b, scale) + determinant_of(c, scale) < 0.0;
}

void main() {
  uint block = global_group();
  if (block >= push.blocks) return;
  uvec2 job = work[block];
  Instance i = instances[job.x];
  uint local = job.y + local_index();
  if (local >= i.triangle_count) return;
  uint t = i.first_triangle + local;
  uint flags = materials[i.material].flags;
  uint word = job.x | ((flags & MATERIAL_MASK) != 0u ? TRIANGLE_MASKED : 0u) |
              ((flags & (MATERIAL_BLEND | MATERIAL_TRANSMISSIVE)) != 0u ? TRIANGLE_TRANSLUCENT : 0u) |
              ((flags & MATERIAL_ONE_SIDED) != 0u ? TRIANGLE_ONE_SIDED : 0u) |
              (i.determinant_sign < 0.0 || mirrored(i, t) ? TRIANGLE_MIRRORED : 0u) | (i.marks & ~INSTANCE_DEFORM);
  if (TRANSFORM_ON_FETCH) {
    TriangleWords(frame.triangles_at).word[t] = word;
    return;
  }
  Triangles(frame.triangles_at).triangle[t] = transform_triangle(i, t, word);
}
