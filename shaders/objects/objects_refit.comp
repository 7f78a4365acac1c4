// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// Boxes of the object hierarchy's nodes, one height at a time from the leaves: a node's height is listed once all its
// children's are done. Boxes of triangles are widened by box_pad, so that triangle.glsl's argument holds.
#define COMPUTE
#include "lib/common.glsl"
#include "interface/push/objects.h"
#include "lib/push.glsl"
#include "lists/rays.glsl"
#include "scene/node.glsl"
layout(buffer_reference, scalar, buffer_reference_align = 8) coherent buffer Words { uint word[]; };
BUFFER(ROLE_REFIT_NODES, readonly, uint, work);  // nodes of this height
PUSH(RefitPush);

void leaf_box(uint child, out vec3 lo, out vec3 hi) {
  uint first = leaf_first(child), count = leaf_count(child);
  lo = vec3(INFINITY);
  hi = vec3(-INFINITY);
  for (uint t = first; t < first + count; ++t) {
    Corners v = load_triangle(t);
    lo = min(lo, min(min(v.a, v.b), v.c));
    hi = max(hi, max(max(v.a, v.b), v.c));
  }
  precise vec3 padded_lo = lo - frame.box_pad, padded_hi = hi + frame.box_pad;
  lo = max(padded_lo, vec3(-3.4028235e38));  // a grid has a finite origin; its far end may be infinite
  hi = padded_hi;
}

uint greatest_byte(uvec2 bytes) {
  uint most = 0u;
  for (uint c = 0u; c < WIDE; ++c) most = max(most, byte_of(bytes, c));
  return most;
}

// Of the decoded boxes. The lowest stands on the origin; absent children have 0 for their high ends.
void node_box(uint node, out vec3 lo, out vec3 hi) {
  Words nodes = Words(frame.nodes_at);
  uint at = node * NODE_WORDS;
  Grid grid = unpack_grid(uvec2(nodes.word[at], nodes.word[at + 1u]), uvec2(nodes.word[at + 2u], nodes.word[at + 3u]));
  uvec3 most;
  for (uint axis = 0u; axis < 3u; ++axis) {
    uint words = at + NODE_BOXES + 6u + 2u * axis;
    most[axis] = greatest_byte(uvec2(nodes.word[words], nodes.word[words + 1u]));
  }
  lo = grid.origin;
  hi = on_grid(grid, most);
  if (grid.present == 0u) {
    lo = vec3(INFINITY);
    hi = vec3(-INFINITY);
  }
}

float decode(float origin, float step, int place) {
  precise float p = origin + float(place) * step;
  return p;
}

float step_of(uint exponent) { return uintBitsToFloat(exponent << 23); }

// The least step of which 255 reach from lo to hi. 2^-125 … 2^126: no product is denormal, and the reciprocal exists.
uint exponent_for(float lo, float hi) {
  uint e = clamp((floatBitsToUint(max(hi - lo, 0.0) * (1.0 / 255.0)) >> 23) & 255u, 2u, 253u);
  while (e < 253u && !(decode(lo, step_of(e), 255) >= hi)) ++e;
  return e;
}

uint round_down(float origin, uint exponent, float v) {
  float scaled = (v - origin) * step_of(254u - exponent);
  int place = int(clamp(floor(scaled), 0.0, 255.0));
  while (place > 0 && decode(origin, step_of(exponent), place) > v) --place;
  return uint(place);
}

uint round_up(float origin, uint exponent, float v) {
  float scaled = (v - origin) * step_of(254u - exponent);
  int place = int(clamp(ceil(scaled), 0.0, 255.0));
  while (place < 255 && decode(origin, step_of(exponent), place) < v) ++place;
  return uint(place);
}

void main() {
  uint i = global_index();
  if (i >= push.count) return;
  uint at = work[push.first + i] * NODE_WORDS;
  Words nodes = Words(frame.nodes_at);
  vec3 lo[WIDE], hi[WIDE], least = vec3(INFINITY), most = vec3(-INFINITY);
  uint present = 0u;
  [[unroll]] for (uint c = 0u; c < WIDE; ++c) {
    uint child = nodes.word[at + NODE_CHILD + c];
    lo[c] = vec3(INFINITY);
    hi[c] = vec3(-INFINITY);
    if (child == CHILD_EMPTY) continue;
    if (is_node(child))
      node_box(child, lo[c], hi[c]);
    else
      leaf_box(child, lo[c], hi[c]);
    if (lo[c].x <= hi[c].x) present |= 1u << c;
    least = min(least, lo[c]);
    most = max(most, hi[c]);
  }
  if (present == 0u) least = most = vec3(0);
  uint words[16];
  for (uint w = 0u; w < 16u; ++w) words[w] = 0u;
  words[NODE_STEPS] = present << 24;
  [[unroll]] for (uint axis = 0u; axis < 3u; ++axis) {
    uint e = exponent_for(least[axis], most[axis]);
    words[axis] = floatBitsToUint(least[axis]);
    words[NODE_STEPS] |= e << (8u * axis);
    [[unroll]] for (uint c = 0u; c < WIDE; ++c) {
      bool is_present = (present & (1u << c)) != 0u;
      uint low = is_present ? round_down(least[axis], e, lo[c][axis]) : 255u;
      uint high = is_present ? round_up(least[axis], e, hi[c][axis]) : 0u;
      words[NODE_BOXES + 2u * axis + c / 4u] |= low << (8u * (c & 3u));
      words[NODE_BOXES + 6u + 2u * axis + c / 4u] |= high << (8u * (c & 3u));
    }
  }
  for (uint w = 0u; w < 16u; ++w) nodes.word[at + w] = words[w];
}
