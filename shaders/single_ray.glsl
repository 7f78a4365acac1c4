// SPDX-License-Identifier: MIT
// One ray a lane through the object hierarchy, depth first, nearer children first. Exact: see triangle.glsl.
//
// On a CPU device an `if` is no jump: all lanes run both sides under a mask, and only loops end early. So the walk is two inner
// loops, one that descends until every lane has a leaf and one that tests leaves' triangles; and a node's children are tested
// as straight-line code.
#include "node.glsl"
layout(constant_id = 1) const bool ANY_HIT = false;

struct Tests {
  uint boxes;
  uint triangles;
};

bool defers() { return ANY_HIT ? TRANSLUCENT : MASKED; }

const uint NEXT = 0xFFFFFFFEu;  // in place of a child: take the next from the stack (no leaf reads so: it would end past 2^27)

struct Walk {
  uint current;  // a node, the rest of a leaf, NEXT, or CHILD_EMPTY: done
  uint group;    // node · 256 + mask of its children still to visit, in visiting order
  uint depth;    // of the stack of groups
  uint octant;
};

uint stack[STACK_SIZE];

bool is_node(uint child) { return (child & CHILD_LEAF) == 0u; }
bool is_rest_of_leaf(uint child) { return !is_node(child) && child < NEXT; }

uint next_child(inout Walk w) {
  if ((w.group & 255u) == 0u) {
    if (w.depth == 0u) return CHILD_EMPTY;
    --w.depth;
    w.group = stack[w.depth];
  }
  uint slot = uint(findLSB(w.group & 255u)) ^ w.octant;
  uvec2 pair = unpack32(node_pairs(w.group >> 8).pair[(NODE_CHILD + slot) / 2u]);
  w.group &= w.group - 1u;
  return (slot & 1u) != 0u ? pair.y : pair.x;
}

// Tests a node's children; those entered become the group at work.
void step_node(uint node, Ray ray, Shear s, float farthest, inout Walk w, inout Tests tests) {
  NodePairs words = node_pairs(node);
  Grid grid = unpack_grid(unpack32(words.pair[0]), unpack32(words.pair[1]));
  uvec2 lx = unpack32(words.pair[2]), ly = unpack32(words.pair[3]), lz = unpack32(words.pair[4]);
  uvec2 hx = unpack32(words.pair[5]), hy = unpack32(words.pair[6]), hz = unpack32(words.pair[7]);
  uint entered = 0u;
  for (uint c = 0u; c < WIDE; ++c) {
    vec3 lo = on_grid(grid, uvec3(byte_of(lx, c), byte_of(ly, c), byte_of(lz, c)));
    vec3 hi = on_grid(grid, uvec3(byte_of(hx, c), byte_of(hy, c), byte_of(hz, c)));
    vec2 range = slab(s, lo, hi);
    entered |= range.x <= range.y && range.y >= ray.tmin && range.x <= farthest ? 1u << c : 0u;
  }
  tests.boxes += WIDE;
  entered = in_visiting_order(entered & grid.there, w.octant);
  w.current = NEXT;
  if (entered == 0u) return;
  if ((w.group & 255u) != 0u) {
    stack[w.depth] = w.group;
    ++w.depth;
  }
  w.group = (node << 8) | entered;
}

// The first triangle of what is left of a leaf.
void step_leaf(Ray ray, Shear s, inout Walk w, inout Nearest best, inout Shade shade, inout Pending pending, inout Tests tests) {
  ++tests.triangles;
  uint triangle = w.current & 0x07FFFFFFu;
  if (ANY_HIT)
    consider_shadow(triangle, s, ray.tmin, ray.tmax, shade, pending);
  else
    consider_nearest(triangle, s, ray.tmin, best, pending);
  w.current = (w.current & 0x78000000u) == 0u ? NEXT : w.current - (1u << 27) + 1u;
  if (ANY_HIT && shade.blocked) w.current = CHILD_EMPTY;
}

// Until the ray is done or a material must be asked.
void walk_on(Ray ray, Shear s, inout Walk w, inout Nearest best, inout Shade shade, inout Pending pending, inout Tests tests) {
  while (w.current != CHILD_EMPTY && pending.triangle == NO_INDEX) {
    while (is_node(w.current) || w.current == NEXT) {
      if (w.current == NEXT) w.current = next_child(w);
      if (is_node(w.current)) step_node(w.current, ray, s, best.t, w, tests);
    }
    while (is_rest_of_leaf(w.current) && pending.triangle == NO_INDEX) step_leaf(ray, s, w, best, shade, pending, tests);
  }
}

void trace_single(Ray ray, inout Nearest best, inout Shade shade, inout Tests tests) {
  Shear s = make_shear(ray.origin, ray.direction);
  Walk w = Walk(0u, 0u, 0u, octant_of(ray.direction));
  Pending pending = NOTHING_PENDING;
  if (!defers()) {
    walk_on(ray, s, w, best, shade, pending, tests);
    return;
  }
  while (w.current != CHILD_EMPTY) {
    walk_on(ray, s, w, best, shade, pending, tests);
    if (pending.triangle == NO_INDEX) continue;
    if (ANY_HIT)
      settle_shadow(ray.direction, ray.tmax, shade, pending);
    else
      settle_nearest(best, pending);
    if (ANY_HIT && shade.blocked) w.current = CHILD_EMPTY;
  }
}
