// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// Vertices of skinned and morphed instances, in world space relative to the frame origin: position, normal, tangent;
// and their texture coordinates and colors, where these are morphed. glTF 2.0, 3.7.2.2 (morph targets) and 3.7.3
// (skins). A workgroup takes one block of up to GROUP vertices of one instance.
#define COMPUTE
#include "lib/common.glsl"
#include "interface/push/animate.h"
#include "lib/push.glsl"
#include "lists/rays.glsl"
#include "scene/memory.glsl"
#include "lib/unit.glsl"
#include "animate/skin.glsl"
layout(constant_id = SPEC_FACE_TANGENTS) const bool FACE_TANGENTS = false;  // some mesh has them
// So have texture coordinates or colors.
layout(constant_id = SPEC_MORPHED_ATTRIBUTES) const bool MORPHED_ATTRIBUTES = false;
layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer NewUv { vec2 v; };
layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer NewColor { vec4 v; };
BUFFER(ROLE_INSTANCES, readonly, Instance, instances);
BUFFER(ROLE_DYNAMIC, writeonly, vec3, dynamic_vertices);
BUFFER(ROLE_DEFORM, readonly, Deform, deforms);
BUFFER(ROLE_MORPHS, readonly, vec3, morphs);
BUFFER(ROLE_MORPH_WEIGHTS, readonly, float, morph_weights);
BUFFER(ROLE_ANIMATE_BLOCKS, readonly, uvec2, work);  // (deforming instance, first vertex)
PUSH(AnimatePush);

vec3 morphed(vec3 base, Deform d, uint first, uint v) {
  if (first == NO_INDEX) return base;
  for (uint k = 0u; k < d.morph_targets; ++k)
    base += morph_weights[d.weight_first + k] * morphs[first + k * d.vertex_count + v];
  return base;
}

Rows rows_of(Deform d, uint v) {
  if (d.joint_words != NO_INDEX) return blended_matrix(d, v);
  Instance i = instances[d.instance];
  return Rows(vec4(i.row0, i.translation.x), vec4(i.row1, i.translation.y), vec4(i.row2, i.translation.z));
}

vec3 turned(Rows m, vec3 p) { return vec3(dot(m.r0.xyz, p), dot(m.r1.xyz, p), dot(m.r2.xyz, p)); }

vec3 placed(Rows m, Deform d, uint v) {
  vec3 p = morphed(load_position(d.first_vertex + v), d, d.morph_first, v);
  precise vec3 world = vec3(dot(m.r0.xyz, p), dot(m.r1.xyz, p), dot(m.r2.xyz, p)) + vec3(m.r0.w, m.r1.w, m.r2.w);
  return world;
}

// Of a flat mesh 0: the normal is that of the triangle, wherever its corners are.
vec3 world_normal(Rows m, Deform d, uint v) {
  if (d.flat_faces != 0u) return vec3(0);
  vec3 n = morphed(load_normal(d.first_vertex + v), d, d.morph_normals, v);
  if (d.joint_words != NO_INDEX) {
    float scale = inverse_scale(max_of(max(max(abs(m.r0.xyz), abs(m.r1.xyz)), abs(m.r2.xyz))));
    vec3 s0 = scale * m.r0.xyz, s1 = scale * m.r1.xyz, s2 = scale * m.r2.xyz;
    vec3 c0 = cross(s1, s2), c1 = cross(s2, s0), c2 = cross(s0, s1);  // cofactors, row by row
    float sign_of = dot(s0, c0) < 0.0 ? -1.0 : 1.0;
    n = sign_of * vec3(dot(c0, n), dot(c1, n), dot(c2, n));
  } else {
    Instance i = instances[d.instance];
    n = vec3(dot(i.normal0, n), dot(i.normal1, n), dot(i.normal2, n));
  }
  return safe_normalize(n, vec3(0));
}

vec3 world_tangent(Rows m, Deform d, uint v) {
  if (d.tangent == NO_INDEX) return vec3(0);
  if (FACE_TANGENTS && d.face_tangents != NO_INDEX) {
    uint face = v / 3u, first = 3u * face;
    vec3 weights = morphs[d.face_tangents + face];
    vec3 a = placed(rows_of(d, first), d, first);
    return weights.x * (placed(rows_of(d, first + 1u), d, first + 1u) - a) +
           weights.y * (placed(rows_of(d, first + 2u), d, first + 2u) - a);
  }
  return turned(m, morphed(load_tangent(d.tangent + v).xyz, d, d.morph_tangents, v));
}

void morph_uv(Deform d, uint set, uint v) {
  if (d.uv_morphs[set] == NO_INDEX) return;
  vec2 uv = morphed(vec3(load_uv(d.uv_from[set] + v), 0), d, d.uv_morphs[set], v).xy;
  NewUv(pack64(frame.uvs_at) + uint64_t((d.uv_to[set] + v) * 8u)).v = uv;
}

// glTF 2.0, 3.7.2.2: clamped once the deltas are applied.
void morph_color(Deform d, uint v) {
  if (d.color_morphs == NO_INDEX && d.alpha_morphs == NO_INDEX) return;
  vec4 color = load_color(d.color_from + v);
  color = vec4(morphed(color.rgb, d, d.color_morphs, v), morphed(vec3(color.a, 0, 0), d, d.alpha_morphs, v).x);
  NewColor(pack64(frame.colors_at) + uint64_t((d.color_to + v) * 16u)).v = clamp(color, 0.0, 1.0);
}

void main() {
  uint block = global_group();
  if (block >= push.blocks) return;
  uvec2 job = work[block];
  Deform d = deforms[job.x];
  uint v = job.y + local_index();
  if (v >= d.vertex_count) return;
  Rows m = rows_of(d, v);
  uint to = 3u * (d.dynamic + v);
  dynamic_vertices[to] = placed(m, d, v);
  dynamic_vertices[to + 1u] = world_normal(m, d, v);
  dynamic_vertices[to + 2u] = world_tangent(m, d, v);
  if (!MORPHED_ATTRIBUTES) return;
  morph_uv(d, 0u, v);
  morph_uv(d, 1u, v);
  morph_color(d, v);
}
