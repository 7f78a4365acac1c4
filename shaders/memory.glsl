// SPDX-License-Identifier: MIT
// What makes up the scene is read by address, triangles and nodes two words at a time. A descriptor's bounds are checked for
// every lane and word that lanes gather, which on a CPU device costs more than the load; and a buffer behind an address may be
// larger than maxStorageBufferRange. Indices come from buffers that the engine filled itself.
#ifndef SHEAF_MEMORY_GLSL
#define SHEAF_MEMORY_GLSL
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
layout(constant_id = SPEC_POSED) const bool POSED = false;  // triangles are posed whenever they are read: only their last word is kept
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer TrianglePairs { uint64_t pair[TRIANGLE_WORDS / 2]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer NodePairs { uint64_t pair[NODE_WORDS / 2]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer WordPairs { uint64_t pair[INSTANCE_WORDS / 2]; };

// Offsets fit 32 bits: a buffer is at most 4 GiB (checked where it is made).
TrianglePairs triangle_pairs(uint triangle) { return TrianglePairs(pack64(frame.triangles_at) + uint64_t(triangle * (4u * TRIANGLE_WORDS))); }
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

// Words 2k … 2k + 3 of a structure.
vec4 load_four(uvec2 buffer_at, uint offset, uint k) {
  WordPairs words = WordPairs(pack64(buffer_at) + uint64_t(offset));
  return uintBitsToFloat(uvec4(unpack32(words.pair[k]), unpack32(words.pair[k + 1u])));
}
uvec2 load_pair(uvec2 buffer_at, uint offset, uint k) { return unpack32(WordPairs(pack64(buffer_at) + uint64_t(offset)).pair[k]); }

Instance load_instance(uint index) {
  uint at = index * (4u * INSTANCE_WORDS);
  vec4 f[5];
  for (uint k = 0u; k < 5u; ++k) f[k] = load_four(frame.instances_at, at, 2u * k);
  uvec2 p[7];
  for (uint k = 0u; k < 7u; ++k) p[k] = load_pair(frame.instances_at, at, 10u + k);
  return Instance(f[0].xyz, vec3(f[0].w, f[1].xy), vec3(f[1].zw, f[2].x), f[2].yzw, f[3].xyz, vec3(f[3].w, f[4].xy),
                  vec3(f[4].zw, uintBitsToFloat(p[0].x)), uintBitsToFloat(p[0].y), p[1].x, p[1].y, p[2].x, p[2].y, p[3].x, p[3].y,
                  p[4].x, p[4].y, p[5].x, p[5].y, p[6].x, 0u);
}

// Without its textures: see load_use.
Material load_material(uint index) {
  uint at = index * (4u * MATERIAL_WORDS);
  vec4 f[4];
  for (uint k = 0u; k < 4u; ++k) f[k] = load_four(frame.materials_at, at, 2u * k);
  uvec2 volume_id = load_pair(frame.materials_at, at, 8u);
  Material m;
  m.base_color = f[0];
  m.emissive = f[1].xyz;
  m.metallic = f[1].w;
  m.roughness = f[2].x;
  m.alpha_cutoff = f[2].y;
  m.transmission = f[2].z;
  m.ior = f[2].w;
  m.absorption = f[3].xyz;
  m.flags = floatBitsToUint(f[3].w);
  m.volume = volume_id.x;
  m.id = volume_id.y;
  return m;
}

TextureUse load_use(uint material, uint place) {
  uint at = 4u * (material * MATERIAL_WORDS + MATERIAL_USES + place * USE_WORDS);
  vec4 a = load_four(frame.materials_at, at, 0u);
  vec2 turn = uintBitsToFloat(load_pair(frame.materials_at, at, 2u));
  uvec2 strength_flags = load_pair(frame.materials_at, at, 3u), first_width = load_pair(frame.materials_at, at, 4u),
        height_levels = load_pair(frame.materials_at, at, 5u);
  return TextureUse(a.xy, a.zw, turn, uintBitsToFloat(strength_flags.x), strength_flags.y, first_width.x, first_width.y,
                    height_levels.x, height_levels.y);
}

struct Corners {
  vec3 a, b, c;
  uint instance;  // and flags, see shared.h
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

Corners pose_triangle(Instance instance, uint triangle, uint word) {
  uvec3 v = triangle_vertices(instance, triangle);
  return Corners(world_position(instance, v.x), world_position(instance, v.y), world_position(instance, v.z), word);
}

Corners load_posed(uint triangle) {
  uint word = OneUint(pack64(frame.triangles_at) + uint64_t(4u * triangle)).v;
  return pose_triangle(load_instance(word & TRIANGLE_INSTANCE_MASK), triangle, word);
}

Corners load_triangle(uint triangle) {
  if (POSED) return load_posed(triangle);
  TrianglePairs words = triangle_pairs(triangle);
  return unpack_triangle(unpack32(words.pair[0]), unpack32(words.pair[1]), unpack32(words.pair[2]), unpack32(words.pair[3]),
                         unpack32(words.pair[4]));
}
#endif
