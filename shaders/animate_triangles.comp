// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// World-space triangles of the instances that moved, relative to the frame origin. A workgroup takes one block of up to GROUP
// triangles of one instance.
#define COMPUTE
#include "common.glsl"
#include "rays.glsl"
#include "memory.glsl"
layout(buffer_reference, scalar, buffer_reference_align = 8) writeonly buffer Triangles { Corners triangle[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer TriangleWords { uint word[]; };
BUFFER(ROLE_INSTANCES, readonly, Instance, instances);
BUFFER(ROLE_MATERIALS, readonly, Material, materials);
BUFFER(ROLE_WORK, readonly, uvec2, work);  // (instance, first triangle within it)
layout(push_constant) uniform Push { uint blocks; } push;

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
              ((flags & (MATERIAL_BLEND | MATERIAL_TRANSMISSIVE)) != 0u ? TRIANGLE_TRANSLUCENT : 0u);
  if (POSED) {
    TriangleWords(frame.triangles_at).word[t] = word;
    return;
  }
  Triangles(frame.triangles_at).triangle[t] = pose_triangle(i, t, word);
}
