// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// Boxes of the object hierarchy's nodes, one height at a time from the leaves: a node's height is listed once all its children's
// are done. Boxes of triangles are widened by box_pad, so that triangle.glsl's argument holds.
#define COMPUTE
#include "common.glsl"
#include "rays.glsl"
BUFFER(ROLE_TRIANGLE_A, readonly, vec3, triangle_a);
BUFFER(ROLE_TRIANGLE_B, readonly, vec3, triangle_b);
BUFFER(ROLE_TRIANGLE_C, readonly, vec3, triangle_c);
BUFFER(ROLE_NODES, coherent, float, nodes);
BUFFER(ROLE_WORK, readonly, uint, work);  // nodes of this height
layout(push_constant) uniform Push {
  uint first;
  uint count;
} push;

void leaf_box(uint child, out vec3 lo, out vec3 hi) {
  uint first = child & 0x07FFFFFFu, count = ((child >> 27) & 15u) + 1u;
  lo = vec3(INFINITY);
  hi = vec3(-INFINITY);
  for (uint t = first; t < first + count; ++t) {
    vec3 a = triangle_a[t], b = triangle_b[t], c = triangle_c[t];
    lo = min(lo, min(min(a, b), c));
    hi = max(hi, max(max(a, b), c));
  }
  precise vec3 padded_lo = lo - frame.box_pad, padded_hi = hi + frame.box_pad;
  lo = padded_lo;
  hi = padded_hi;
}

void node_box(uint node, out vec3 lo, out vec3 hi) {
  lo = vec3(INFINITY);
  hi = vec3(-INFINITY);
  for (uint c = 0u; c < WIDE; ++c) {
    uint at = node * NODE_WORDS + c;
    lo = min(lo, vec3(nodes[at], nodes[at + WIDE], nodes[at + 2u * WIDE]));
    hi = max(hi, vec3(nodes[at + 3u * WIDE], nodes[at + 4u * WIDE], nodes[at + 5u * WIDE]));
  }
}

// One invocation a child: eight lanes fill a node.
void main() {
  uint i = global_index();
  if (i >= push.count * WIDE) return;
  uint node = work[push.first + i / WIDE], c = i % WIDE;
  uint at = node * NODE_WORDS + c;
  uint child = floatBitsToUint(nodes[node * NODE_WORDS + NODE_CHILD + c]);
  vec3 lo = vec3(INFINITY), hi = vec3(-INFINITY);
  if (child != CHILD_EMPTY) {
    if ((child & CHILD_LEAF) != 0u)
      leaf_box(child, lo, hi);
    else
      node_box(child, lo, hi);
  }
  for (uint axis = 0u; axis < 3u; ++axis) {
    nodes[at + axis * WIDE] = lo[axis];
    nodes[at + (3u + axis) * WIDE] = hi[axis];
  }
}
