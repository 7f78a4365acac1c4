// SPDX-License-Identifier: MIT
// What makes up the scene is read by address, triangles and nodes two words at a time. A descriptor's bounds are
// checked for every lane and word that lanes gather, which on a CPU device costs more than the load; and a buffer
// behind an address may be larger than maxStorageBufferRange. Indices come from buffers that the engine filled itself.
#ifndef SHEAF_MEMORY_GLSL
#define SHEAF_MEMORY_GLSL
#include "lib/common.glsl"
#include "lib/frame.glsl"
#include "interface/scene.h"
#include "interface/hierarchy.h"
// Triangles are transformed by their instances whenever they are read: only their last word is kept.
layout(constant_id = SPEC_TRANSFORM_ON_FETCH) const bool TRANSFORM_ON_FETCH = false;
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer TrianglePairs {
  uint64_t pair[TRIANGLE_WORDS / 2];
};
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer NodePairs {
  uint64_t pair[NODE_WORDS / 2];
};
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer WordPairs {
  uint64_t pair[INSTANCE_WORDS / 2];
};

// Offsets fit 32 bits: a buffer is at most 4 GiB (checked where it is made).
TrianglePairs triangle_pairs(uint triangle) {
  return TrianglePairs(pack64(frame.triangles_at) + uint64_t(triangle * (4u * TRIANGLE_WORDS)));
}
NodePairs node_pairs(uint node) { return NodePairs(pack64(frame.nodes_at) + uint64_t(node * (4u * NODE_WORDS))); }

layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer OneUint { uint v; };
uint node_word(uint node, uint k) { return OneUint(pack64(frame.nodes_at) + uint64_t(4u * (node * NODE_WORDS + k))).v; }
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer OneVec2 { vec2 v; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer OneVec3 { vec3 v; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer OneVec4 { vec4 v; };
uint load_index(uint i) { return OneUint(pack64(frame.indices_at) + uint64_t(i * 4u)).v; }
uint load_texel(uint i) { return OneUint(pack64(frame.texels_at) + uint64_t(i * 4u)).v; }
vec2 load_uv(uint i) { return OneVec2(pack64(frame.uvs_at) + uint64_t(i * 8u)).v; }
vec3 load_position(uint i) { return OneVec3(pack64(frame.positions_at) + uint64_t(i * 12u)).v; }
vec3 load_normal(uint i) { return OneVec3(pack64(frame.normals_at) + uint64_t(i * 12u)).v; }
vec3 load_dynamic(uint i) { return OneVec3(pack64(frame.dynamic_at) + uint64_t(i * 12u)).v; }
vec4 load_tangent(uint i) { return OneVec4(pack64(frame.tangents_at) + uint64_t(i * 16u)).v; }
vec4 load_color(uint i) { return OneVec4(pack64(frame.colors_at) + uint64_t(i * 16u)).v; }

uvec2 load_pair(uvec2 buffer_at, uint offset, uint k) {
  return unpack32(WordPairs(pack64(buffer_at) + uint64_t(offset)).pair[k]);
}

// The first of a structure's pairs, of a lane's own structure. (What lanes may share: shading_inputs.glsl.)
#define LOAD_PAIRS(pairs, count, buffer_at, offset) \
  [[unroll]] for (uint k_ = 0u; k_ < (count); ++k_) pairs[k_] = load_pair(buffer_at, offset, k_)

vec2 floats(uvec2 pair) { return uintBitsToFloat(pair); }
vec4 floats(uvec2 first, uvec2 second) { return uintBitsToFloat(uvec4(first, second)); }

// A material's own.
const uint INSTANCE_PAIRS = INSTANCE_WORDS / 2u, MATERIAL_PAIRS = MATERIAL_USES / 2u, USE_PAIRS = USE_WORDS / 2u;

uint instance_offset(uint index) { return index * (4u * INSTANCE_WORDS); }
uint material_offset(uint index) { return index * (4u * MATERIAL_WORDS); }
uint use_offset(uint material, uint place) {
  return material_offset(material) + 4u * (MATERIAL_USES + place * USE_WORDS);
}

Instance unpack_instance(uvec2 p[INSTANCE_PAIRS]) {
  vec4 f[5];
  for (uint k = 0u; k < 5u; ++k) f[k] = floats(p[2u * k], p[2u * k + 1u]);
  return Instance(f[0].xyz, vec3(f[0].w, f[1].xy), vec3(f[1].zw, f[2].x), f[2].yzw, f[3].xyz, vec3(f[3].w, f[4].xy),
                  vec3(f[4].zw, floats(p[10]).x), floats(p[10]).y, p[11].x, p[11].y, p[12].x, p[12].y, p[13].x, p[13].y,
                  p[14].x, p[14].y, p[15].x, p[15].y, p[16].x, p[16].y);
}

#define TAKE_float(to) to = uintBitsToFloat(word[at++])
#define TAKE_vec3(to) to = uintBitsToFloat(uvec3(word[at], word[at + 1u], word[at + 2u])), at += 3u
#define TAKE_vec4(to) to = uintBitsToFloat(uvec4(word[at], word[at + 1u], word[at + 2u], word[at + 3u])), at += 4u
#define TAKE(type, words, field, value, owner, key, low, high) TAKE_##type(m.field);

// Without its textures: see load_use.
Material unpack_material(uvec2 p[MATERIAL_PAIRS]) {
  uint word[MATERIAL_USES], at = 0u;
  [[unroll]] for (uint k = 0u; k < MATERIAL_PAIRS; ++k) {
    word[2u * k] = p[k].x;
    word[2u * k + 1u] = p[k].y;
  }
  Material m;
  MATERIAL_FACTORS(TAKE)
  TAKE_vec3(m.absorption);
  m.flags = word[at++];
  m.volume = word[at++];
  m.id = word[at];
  return m;
}
#undef TAKE

TextureUse unpack_use(uvec2 p[USE_PAIRS]) {
  return TextureUse(floats(p[0]), floats(p[1]), floats(p[2]), floats(p[3]).x, p[3].y, p[4].x, p[4].y, p[5].x, p[5].y);
}

Instance load_instance(uint index) {
  uvec2 p[INSTANCE_PAIRS];
  LOAD_PAIRS(p, INSTANCE_PAIRS, frame.instances_at, instance_offset(index));
  return unpack_instance(p);
}

Material load_material(uint index) {
  uvec2 p[MATERIAL_PAIRS];
  LOAD_PAIRS(p, MATERIAL_PAIRS, frame.materials_at, material_offset(index));
  return unpack_material(p);
}

TextureUse load_use(uint material, uint place) {
  uvec2 p[USE_PAIRS];
  LOAD_PAIRS(p, USE_PAIRS, frame.materials_at, use_offset(material, place));
  return unpack_use(p);
}

struct Corners {
  vec3 a, b, c;
  uint instance;  // and flags, see interface/scene.h
};

Corners unpack_triangle(uvec2 p0, uvec2 p1, uvec2 p2, uvec2 p3, uvec2 p4) {
  vec4 v0 = uintBitsToFloat(uvec4(p0, p1)), v1 = uintBitsToFloat(uvec4(p2, p3));
  return Corners(v0.xyz, vec3(v0.w, v1.xy), vec3(v1.zw, uintBitsToFloat(p4.x)), p4.y);
}

uvec3 triangle_vertices(Instance instance, uint triangle) {
  uint first = instance.first_index + 3u * (triangle - instance.first_triangle);
  return uvec3(load_index(first), load_index(first + 1u), load_index(first + 2u));
}

// The same bits in whichever kernel.
vec3 world_position(Instance i, uint v) {
  if (i.dynamic != NO_INDEX) return load_dynamic(3u * (i.dynamic + v));
  vec3 p = load_position(i.first_vertex + v);
  precise vec3 world = vec3(dot(i.row0, p), dot(i.row1, p), dot(i.row2, p)) + i.translation;
  return world;
}

Corners transform_triangle(Instance instance, uint triangle, uint word) {
  uvec3 v = triangle_vertices(instance, triangle);
  return Corners(world_position(instance, v.x), world_position(instance, v.y), world_position(instance, v.z), word);
}

Corners fetch_transformed(uint triangle) {
  uint word = OneUint(pack64(frame.triangles_at) + uint64_t(4u * triangle)).v;
  return transform_triangle(load_instance(word & TRIANGLE_INSTANCE_MASK), triangle, word);
}

Corners load_triangle(uint triangle) {
  if (TRANSFORM_ON_FETCH) return fetch_transformed(triangle);
  TrianglePairs words = triangle_pairs(triangle);
  return unpack_triangle(unpack32(words.pair[0]), unpack32(words.pair[1]), unpack32(words.pair[2]),
                         unpack32(words.pair[3]), unpack32(words.pair[4]));
}
#endif
