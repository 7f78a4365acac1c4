// SPDX-License-Identifier: MIT
// One ray per lane through the object hierarchy, depth first, nearer children first. Exact: see triangle.glsl.
//
// On a CPU device an `if` is passed over only where no lane takes it, and a loop runs until its last lane is done. So
// the walk is two inner loops, one that descends until every lane has a leaf and one that tests leaves' triangles; and
// a node's children are tested as straight-line code.
#ifndef SHEAF_SINGLE_RAY_GLSL
#define SHEAF_SINGLE_RAY_GLSL
#include "trace/single/walk.glsl"
#include "lists/rays.glsl"
#include "scene/triangle.glsl"
#include "trace/common/candidate.glsl"
#include "trace/common/visit.glsl"
#include "scene/node_boxes.glsl"

bool is_rest_of_leaf(uint child) { return !is_node(child) && child < NEXT; }

// Tests a node's children; those entered become the group at work.
void step_node(uint node, Ray ray, Shear s, float farthest, inout Walk w, inout Tests tests) {
  Boxes boxes = turned_boxes(load_boxes(node), lessThan(s.inverse, vec3(0)));
  uint entered = 0u;
  for (uint c = 0u; c < WIDE; ++c) {
    vec3 near, far;
    child_box(boxes, c, near, far);
    vec2 range = slab_in_order(s, near, far);
    entered |= range.x <= range.y && range.y >= ray.tmin && range.x <= farthest ? 1u << c : 0u;
  }
  tests.boxes += WIDE;
  visit_children(w.visit, node, entered & boxes.grid.present);
  w.current = NEXT;
}

// The first triangle of what is left of a leaf.
void step_leaf(Ray ray, Shear s, inout Walk w, inout Nearest best, inout Shade shade, inout Pending pending,
               inout Tests tests) {
  ++tests.triangles;
  uint triangle = leaf_first(w.current);
  if (ANY_HIT)
    consider_shadow(triangle, s, ray.tmin, ray.tmax, shade, pending);
  else
    consider_nearest(triangle, s, ray.tmin, best, pending);
  w.current = leaf_count(w.current) == 1u ? NEXT : w.current - (1u << 27) + 1u;
  if (ANY_HIT && shade.blocked) w.current = CHILD_EMPTY;
}

// Until the ray is done or a material must be asked.
void walk_on(Ray ray, Shear s, inout Walk w, inout Nearest best, inout Shade shade, inout Pending pending,
             inout Tests tests) {
  while (w.current != CHILD_EMPTY && pending.triangle == NO_INDEX) {
    while (is_node(w.current) || w.current == NEXT) {
      uint place;
      if (w.current == NEXT) w.current = next_child(w.visit, place);
      if (is_node(w.current)) step_node(w.current, ray, s, best.t, w, tests);
    }
    while (is_rest_of_leaf(w.current) && pending.triangle == NO_INDEX)
      step_leaf(ray, s, w, best, shade, pending, tests);
  }
}

#ifdef PACKETS  // not a constant: what is never run would still be read and inlined at each start
#include "trace/single/packet.glsl"
#endif

void trace_single(Ray ray, inout Nearest best, inout Shade shade, inout Tests tests) {
  Shear s = make_shear(ray.origin, ray.direction);
  Walk w = Walk(0u, Visit(0u, 0u, octant_of(ray.direction)));
#ifdef PACKETS
  walk_packet(ray, s, w, best, shade, tests);
#endif
  Pending pending = NOTHING_PENDING;
  if (!asks_materials()) {
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
#endif
