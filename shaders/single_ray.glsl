// SPDX-License-Identifier: MIT
// One ray a lane through the object hierarchy: depth first, the nearest child next, the rest stacked with their entry so
// that a found t prunes them. Exact: see triangle.glsl.
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_vote : require
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

bool defers() { return ANY_HIT ? TRANSLUCENT : MASKED; }

struct Walk {
  uint current;        // node or leaf to do next
  float entry;
  uint next, last;     // triangles of the leaf at work
  uint depth;
  bool done;
};

// One triangle of the leaf at work.
void test_triangle(uint triangle, Ray ray, Shear s, inout Nearest best, inout Shade shade, inout Pending pending) {
  if (ANY_HIT)
    consider_shadow(triangle, s, ray.tmin, ray.tmax, shade, pending);
  else
    consider_nearest(triangle, s, ray.tmin, best, pending);
}

void step_triangle(Ray ray, Shear s, inout Walk w, inout Nearest best, inout Shade shade, inout Pending pending, inout Tests tests) {
  ++tests.triangles;
  uint first = subgroupBroadcastFirst(w.next);
  if (subgroupAll(w.next == first))
    test_triangle(first, ray, s, best, shade, pending);
  else
    test_triangle(w.next, ray, s, best, shade, pending);
  ++w.next;
}

uint stack[STACK_SIZE];
float entries[STACK_SIZE];

// Tests a node's children: the nearest entered is next, the others are stacked. False where none is entered.
bool step_node(uint node, Ray ray, Shear s, float farthest, inout Walk w, inout Tests tests) {
  // Straight-line code over the eight children: a loop that lanes leave one by one costs more than the tests it saves.
  uint child[WIDE];
  float entry[WIDE];
  uint near_index = WIDE, near_child = CHILD_EMPTY;
  float near_entry = INFINITY;
  for (uint c = 0u; c < WIDE; ++c) {
    child[c] = floatBitsToUint(nodes[node * NODE_WORDS + NODE_CHILD + c]);
    entry[c] = child[c] == CHILD_EMPTY ? INFINITY : child_entry(node, c, s, ray.tmin, farthest);
    bool nearer = entry[c] < near_entry;
    near_index = nearer ? c : near_index;
    near_child = nearer ? child[c] : near_child;
    near_entry = nearer ? entry[c] : near_entry;
  }
  tests.boxes += WIDE;
  if (near_index == WIDE) return false;
  for (uint c = 0u; c < WIDE; ++c) {
    if (!(entry[c] < INFINITY) || c == near_index) continue;
    stack[w.depth] = child[c];
    entries[w.depth] = entry[c];
    ++w.depth;
  }
  w.current = near_child;
  w.entry = near_entry;
  return true;
}

// Neighbouring rays often stand at the same node: then its words are loaded once for all lanes, not gathered.
bool step_nodes(Ray ray, Shear s, float farthest, inout Walk w, inout Tests tests) {
  uint first = subgroupBroadcastFirst(w.current);
  if (subgroupAll(w.current == first)) return step_node(first, ray, s, farthest, w, tests);
  return step_node(w.current, ray, s, farthest, w, tests);
}

void pop(inout Walk w) {
  if (w.depth == 0u) {
    w.done = true;
    return;
  }
  --w.depth;
  w.current = stack[w.depth];
  w.entry = entries[w.depth];
}

// Until the ray is done or a material must be asked.
void walk_on(Ray ray, Shear s, inout Walk w, inout Nearest best, inout Shade shade, inout Pending pending, inout Tests tests) {
  while (!w.done) {
    if (w.next < w.last) {
      step_triangle(ray, s, w, best, shade, pending, tests);
      if (ANY_HIT && shade.blocked) w.done = true;
      if (defers() && pending.triangle != NO_INDEX) return;
      if (w.next == w.last) pop(w);
    } else if (!(w.entry <= best.t)) {
      pop(w);
    } else if ((w.current & CHILD_LEAF) != 0u) {
      w.next = w.current & 0x07FFFFFFu;
      w.last = w.next + ((w.current >> 27) & 15u) + 1u;
    } else if (!step_nodes(ray, s, best.t, w, tests)) {
      pop(w);
    }
  }
}

void trace_single(Ray ray, inout Nearest best, inout Shade shade, inout Tests tests) {
  Shear s = make_shear(ray.origin, ray.direction);
  Walk w = Walk(0u, ray.tmin, 0u, 0u, 0u, false);
  Pending pending = NOTHING_PENDING;
  if (!defers()) {
    walk_on(ray, s, w, best, shade, pending, tests);
    return;
  }
  while (!w.done) {
    walk_on(ray, s, w, best, shade, pending, tests);
    if (pending.triangle == NO_INDEX) continue;
    if (ANY_HIT)
      settle_shadow(ray.direction, ray.tmax, shade, pending);
    else
      settle_nearest(best, pending);
    if (ANY_HIT && shade.blocked) w.done = true;
    if (!w.done && w.next == w.last) pop(w);
  }
}
