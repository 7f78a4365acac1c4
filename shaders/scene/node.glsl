// SPDX-License-Identifier: MIT
// Nodes of the object hierarchy: eight boxes on a grid of the node's own (interface/hierarchy.h). Decoding is monotone,
// and what encodes (objects_refit) rounds outwards until the decoded box holds the true one: the containment that
// triangle.glsl relies on.
#ifndef SHEAF_NODE_GLSL
#define SHEAF_NODE_GLSL
#include "interface/hierarchy.h"
#include "scene/memory.glsl"

struct Grid {
  vec3 origin;
  vec3 step;   // powers of two
  uint present;  // a bit a child
};

Grid unpack_grid(uvec2 p0, uvec2 p1) {
  return Grid(uintBitsToFloat(uvec3(p0, p1.x)),
              uintBitsToFloat(uvec3(p1.y & 255u, (p1.y >> 8) & 255u, (p1.y >> 16) & 255u) << 23), p1.y >> 24);
}

vec3 on_grid(Grid g, uvec3 place) {
  precise vec3 p = g.origin + vec3(ivec3(place)) * g.step;
  return p;
}

// The byte of child c of an axis' eight.
uint byte_of(uvec2 bytes, uint c) { return ((c < 4u ? bytes.x : bytes.y) >> (8u * (c & 3u))) & 255u; }

struct Boxes {  // of a node's children
  Grid grid;
  uvec2 lx, ly, lz, hx, hy, hz;
};

void child_box(Boxes b, uint c, out vec3 lo, out vec3 hi) {
  lo = on_grid(b.grid, uvec3(byte_of(b.lx, c), byte_of(b.ly, c), byte_of(b.lz, c)));
  hi = on_grid(b.grid, uvec3(byte_of(b.hx, c), byte_of(b.hy, c), byte_of(b.hz, c)));
}

// The planes of each axis that rays run against are exchanged: what was low is then what such a ray meets first. To
// exchange the bytes of eight boxes takes as much as to exchange one box' planes.
Boxes turned_boxes(Boxes b, bvec3 backwards) {
  return Boxes(b.grid, backwards.x ? b.hx : b.lx, backwards.y ? b.hy : b.ly, backwards.z ? b.hz : b.lz,
               backwards.x ? b.lx : b.hx, backwards.y ? b.ly : b.hy, backwards.z ? b.lz : b.hz);
}

bool is_node(uint child) { return (child & CHILD_LEAF) == 0u; }
uint leaf_first(uint child) { return child & 0x07FFFFFFu; }
uint leaf_count(uint child) { return ((child >> 27) & 15u) + 1u; }

uint octant_of(vec3 direction) {
  return (direction.x < 0.0 ? 1u : 0u) | (direction.y < 0.0 ? 2u : 0u) | (direction.z < 0.0 ? 4u : 0u);
}

// Children of a node stand in the slot of the octant they lie in (slot_order.hpp): visited in the order slot ^ octant
// they come roughly front to back. A mask of slots in that order:
uint in_visiting_order(uint mask, uint octant) {
  if ((octant & 1u) != 0u) mask = ((mask & 0x55u) << 1) | ((mask >> 1) & 0x55u);
  if ((octant & 2u) != 0u) mask = ((mask & 0x33u) << 2) | ((mask >> 2) & 0x33u);
  if ((octant & 4u) != 0u) mask = ((mask & 0x0Fu) << 4) | (mask >> 4);
  return mask;
}
#endif
