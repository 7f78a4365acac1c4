// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// World-space triangles of the instances that moved, relative to the frame origin. A workgroup takes one block of up to GROUP
// triangles of one instance.
#define COMPUTE
#include "common.glsl"
#include "rays.glsl"
#include "memory.glsl"
struct Triangle {
  vec3 a, b, c;
  uint instance;
};
layout(buffer_reference, scalar, buffer_reference_align = 8) writeonly buffer Triangles { Triangle triangle[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer TriangleWords { uint word[]; };
BUFFER(ROLE_INSTANCES, readonly, Instance, instances);
BUFFER(ROLE_MATERIALS, readonly, Material, materials);
BUFFER(ROLE_WORK, readonly, uvec2, work);  // (instance, first triangle within it)
layout(push_constant) uniform Push { uint blocks; } push;

vec3 world_position(Instance i, uint v) {
  if (i.dynamic != NO_INDEX) return load_dynamic(3u * (i.dynamic + v));
  return to_world(i.row0, i.row1, i.row2, i.translation, load_position(i.first_vertex + v));
}

void main() {
  uint block = global_group();
  if (block >= push.blocks) return;
  uvec2 job = work[block];
  Instance i = instances[job.x];
  uint local = job.y + gl_LocalInvocationID.x;
  if (local >= i.triangle_count) return;
  uint first = i.first_index + 3u * local;
  uint t = i.first_triangle + local;
  uint flags = materials[i.material].flags;
  uint word = job.x | ((flags & MATERIAL_MASK) != 0u ? TRIANGLE_MASKED : 0u) |
              ((flags & (MATERIAL_BLEND | MATERIAL_TRANSMISSIVE)) != 0u ? TRIANGLE_TRANSLUCENT : 0u);
  if (POSED) {
    TriangleWords(frame.triangles_at).word[t] = word;
    return;
  }
  Triangles(frame.triangles_at).triangle[t] =
      Triangle(world_position(i, load_index(first)), world_position(i, load_index(first + 1u)),
               world_position(i, load_index(first + 2u)), word);
}
