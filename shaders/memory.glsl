// SPDX-License-Identifier: MIT
// Triangles and nodes of the object hierarchy are read by address, two words at a time. A descriptor's bounds are checked for
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
