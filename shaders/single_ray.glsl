// SPDX-License-Identifier: MIT
// One ray a lane through the object hierarchy: depth first, the nearest child next, the rest stacked with their entry so
// that a found t prunes them. Exact: see triangle.glsl.
layout(constant_id = 1) const bool ANY_HIT = false;
BUFFER(ROLE_NODES, readonly, float, nodes);

struct Tests {
  uint boxes;
  uint triangles;
};

// Entry of child c of a node along the ray, INFINITY where it is missed.
float child_entry(uint node, uint c, Shear s, float tmin, float tmax) {
  uint at = node * NODE_WORDS + c;
  vec3 lo = vec3(nodes[at], nodes[at + WIDE], nodes[at + 2u * WIDE]);
  vec3 hi = vec3(nodes[at + 3u * WIDE], nodes[at + 4u * WIDE], nodes[at + 5u * WIDE]);
  vec2 range = slab(s.origin, s.inverse, lo, hi);
  return range.x <= range.y && range.y >= tmin && range.x <= tmax ? max(range.x, tmin) : INFINITY;
}

void test_leaf(uint child, Ray ray, Shear s, inout Nearest best, inout Shade shade, inout Tests tests) {
  uint first = child & 0x07FFFFFFu, count = ((child >> 27) & 15u) + 1u;
  for (uint i = first; i < first + count; ++i) {
    ++tests.triangles;
    if (ANY_HIT)
      consider_shadow(i, s, ray.direction, ray.tmin, ray.tmax, shade);
    else
      consider_nearest(i, s, ray.tmin, best);
    if (ANY_HIT && shade.blocked) return;
  }
}

void trace_single(Ray ray, inout Nearest best, inout Shade shade, inout Tests tests) {
  Shear s = make_shear(ray.origin, ray.direction);
  uint stack[STACK_SIZE];
  float entries[STACK_SIZE];
  uint depth = 0u;
  uint current = 0u;  // root
  float current_entry = ray.tmin;
  for (;;) {
    if ((current & CHILD_LEAF) != 0u) {
      if (current_entry <= best.t) test_leaf(current, ray, s, best, shade, tests);
      if (ANY_HIT && shade.blocked) return;
    } else if (current_entry <= best.t) {
      uint near_child = CHILD_EMPTY;
      float near_entry = INFINITY;
      for (uint c = 0u; c < WIDE; ++c) {
        uint child = floatBitsToUint(nodes[current * NODE_WORDS + NODE_CHILD + c]);
        if (child == CHILD_EMPTY) break;  // children are packed from the front
        float entry = child_entry(current, c, s, ray.tmin, best.t);
        ++tests.boxes;
        if (!(entry < INFINITY)) continue;
        bool nearer = entry < near_entry;
        uint pushed = nearer ? near_child : child;
        float pushed_entry = nearer ? near_entry : entry;
        if (nearer) {
          near_child = child;
          near_entry = entry;
        }
        if (pushed != CHILD_EMPTY) {
          stack[depth] = pushed;
          entries[depth] = pushed_entry;
          ++depth;
        }
      }
      if (near_child != CHILD_EMPTY) {
        current = near_child;
        current_entry = near_entry;
        continue;
      }
    }
    if (depth == 0u) return;
    --depth;
    current = stack[depth];
    current_entry = entries[depth];
  }
}
