// SPDX-License-Identifier: MIT
// What makes up the scene is read by address, triangles and nodes two words at a time. A descriptor's bounds are checked for
// every lane and word that lanes gather, which on a CPU device costs more than the load; and a buffer behind an address may be
// larger than maxStorageBufferRange. Indices come from buffers that the engine filled itself.
#ifndef SHEAF_MEMORY_GLSL
#define SHEAF_MEMORY_GLSL
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer TrianglePairs { uint64_t pair[TRIANGLE_WORDS / 2]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer NodePairs { uint64_t pair[NODE_WORDS / 2]; };

// Offsets fit 32 bits: a buffer is at most 4 GiB (checked where it is made).
TrianglePairs triangle_pairs(uint triangle) { return TrianglePairs(pack64(frame.triangles_at) + uint64_t(triangle * (4u * TRIANGLE_WORDS))); }
NodePairs node_pairs(uint node) { return NodePairs(pack64(frame.nodes_at) + uint64_t(node * (4u * NODE_WORDS))); }

layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer OneUint { uint v; };
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

vec3 load_corner(uint triangle, uint corner) {
  return OneVec3(pack64(frame.triangles_at) + uint64_t(triangle * (4u * TRIANGLE_WORDS) + 12u * corner)).v;
}

struct Corners {
  vec3 a, b, c;
  uint instance;  // and flags, see shared.h
};

Corners unpack_triangle(uvec2 p0, uvec2 p1, uvec2 p2, uvec2 p3, uvec2 p4) {
  vec4 v0 = uintBitsToFloat(uvec4(p0, p1)), v1 = uintBitsToFloat(uvec4(p2, p3));
  return Corners(v0.xyz, vec3(v0.w, v1.xy), vec3(v1.zw, uintBitsToFloat(p4.x)), p4.y);
}

Corners load_triangle(uint triangle) {
  TrianglePairs words = triangle_pairs(triangle);
  return unpack_triangle(unpack32(words.pair[0]), unpack32(words.pair[1]), unpack32(words.pair[2]), unpack32(words.pair[3]),
                         unpack32(words.pair[4]));
}
#endif
