// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// Vertices of skinned and morphed instances, in world space relative to the frame origin: position, normal, tangent.
// glTF 2.0, 3.7.2.2 (morph targets) and 3.7.3 (skins). A workgroup takes one block of up to GROUP vertices of one instance.
#define COMPUTE
#include "common.glsl"
#include "rays.glsl"
#include "memory.glsl"
#include "unit.glsl"
BUFFER(ROLE_INSTANCES, readonly, Instance, instances);
BUFFER(ROLE_DYNAMIC, writeonly, vec3, dynamic_vertices);
BUFFER(ROLE_DEFORM, readonly, Deform, deforms);
BUFFER(ROLE_JOINTS, readonly, uint, joints);
BUFFER(ROLE_MORPHS, readonly, vec3, morphs);
BUFFER(ROLE_SCAN_IN, readonly, vec4, joint_rows);  // three rows a matrix
BUFFER(ROLE_SCAN_OUT, readonly, float, morph_weights);
BUFFER(ROLE_WORK, readonly, uvec2, work);          // (deforming instance, first vertex)
layout(push_constant) uniform Push { uint blocks; } push;

vec3 morphed(vec3 base, Deform d, uint first, uint v) {
  if (first == NO_INDEX) return base;
  for (uint k = 0u; k < d.morph_targets; ++k) base += morph_weights[d.weight_first + k] * morphs[first + k * d.vertex_count + v];
  return base;
}

void blended_matrix(Deform d, uint v, out vec4 r0, out vec4 r1, out vec4 r2) {
  r0 = r1 = r2 = vec4(0);
  uint at = d.joint_words + 12u * v;
  for (uint k = 0u; k < 8u; ++k) {
    float weight = uintBitsToFloat(joints[at + 4u + k]);
    if (weight == 0.0) continue;
    uint joint = (joints[at + k / 2u] >> (16u * (k % 2u))) & 0xFFFFu;
    uint m = 3u * (d.first_matrix + joint);
    r0 += weight * joint_rows[m];
    r1 += weight * joint_rows[m + 1u];
    r2 += weight * joint_rows[m + 2u];
  }
}

void main() {
  uint block = global_group();
  if (block >= push.blocks) return;
  uvec2 job = work[block];
  Deform d = deforms[job.x];
  uint v = job.y + local_index();
  if (v >= d.vertex_count) return;
  vec3 p = morphed(load_position(d.first_vertex + v), d, d.morph_first, v);
  vec3 n = morphed(load_normal(d.first_vertex + v), d, d.morph_normals, v);
  vec3 t = vec3(0);
  if (d.tangent != NO_INDEX) t = morphed(load_tangent(d.tangent + v).xyz, d, d.morph_tangents, v);
  vec4 r0, r1, r2;
  if (d.joint_words != NO_INDEX) {
    blended_matrix(d, v, r0, r1, r2);
    float scale = inverse_scale(max_of(max(max(abs(r0.xyz), abs(r1.xyz)), abs(r2.xyz))));
    vec3 s0 = scale * r0.xyz, s1 = scale * r1.xyz, s2 = scale * r2.xyz;
    vec3 c0 = cross(s1, s2), c1 = cross(s2, s0), c2 = cross(s0, s1);  // cofactors, row by row
    float sign_of = dot(s0, c0) < 0.0 ? -1.0 : 1.0;
    n = sign_of * vec3(dot(c0, n), dot(c1, n), dot(c2, n));
  } else {
    Instance i = instances[d.instance];
    r0 = vec4(i.row0, i.translation.x);
    r1 = vec4(i.row1, i.translation.y);
    r2 = vec4(i.row2, i.translation.z);
    n = vec3(dot(i.normal0, n), dot(i.normal1, n), dot(i.normal2, n));
  }
  uint to = 3u * (d.dynamic + v);
  precise vec3 world = vec3(dot(r0.xyz, p), dot(r1.xyz, p), dot(r2.xyz, p)) + vec3(r0.w, r1.w, r2.w);
  dynamic_vertices[to] = world;
  dynamic_vertices[to + 1u] = safe_normalize(n, vec3(0));
  dynamic_vertices[to + 2u] = vec3(dot(r0.xyz, t), dot(r1.xyz, t), dot(r2.xyz, t));
}
