// SPDX-License-Identifier: MIT
// A packet: the rays of a subgroup, a ray per lane, that walk the object hierarchy together while they keep together.
// Nodes and triangles are loaded once for all, a pair of words per lane, and a node's boxes are decoded at once, a box
// a lane; only the tests are each ray's own. On a CPU device a step costs less than half of what it costs where each
// lane has a node of its own (single_ray.glsl), so it may enter nodes that few of its rays enter, and still be ahead.
// Where too few do, the rays go on alone. All lanes of the subgroup are active throughout; one without a ray has a
// farthest hit of −∞.
#ifndef SHEAF_PACKET_GLSL
#define SHEAF_PACKET_GLSL
#include "lists/rays.glsl"
#include "scene/node_boxes.glsl"
#include "trace/common/candidate.glsl"
#include "trace/single/walk.glsl"
#include "lib/lanes.glsl"
#include "trace/common/visit_subgroup.glsl"
#include "scene/load_uniform.glsl"

// Hits that wait for their material, so that it is asked for many at once.
const uint MOST_WAITING = 4u;
Pending waiting[MOST_WAITING];
uint waiting_count = 0u;  // of this lane
uint most_waiting = 0u;   // of no lane more; the same in all

void settle_all(Ray ray, inout Nearest best, inout Shade shade) {
  while (any_lane(waiting_count > 0u)) {
    if (waiting_count == 0u) continue;
    --waiting_count;
    Pending p = waiting[waiting_count];
    if (ANY_HIT) {
      if (best.t > -INFINITY) settle_shadow(ray.direction, ray.tmax, shade, p);
      if (shade.blocked) best.t = -INFINITY;
    } else if (p.t < best.t || (p.t == best.t && p.triangle < best.triangle)) {
      settle_nearest(best, p);
    }
  }
}

void wait_for_material(Ray ray, Pending pending, inout Nearest best, inout Shade shade) {
  if (pending.triangle != NO_INDEX) {
    waiting[waiting_count] = pending;
    ++waiting_count;
  }
  if (++most_waiting < MOST_WAITING) return;
  most_waiting = to_uint(max_lanes(float(waiting_count)));
  if (most_waiting < MOST_WAITING) return;
  settle_all(ray, best, shade);
  most_waiting = 0u;
}

void test_triangle(Corners corners, uint triangle, bool enters, Ray ray, Shear s, inout Nearest best, inout Shade shade,
                   inout Tests tests) {
  Pending pending = NOTHING_PENDING;
  if (enters && best.t > -INFINITY) {
    ++tests.triangles;
    if (ANY_HIT) {
      consider_shadow_corners(corners, triangle, s, ray.tmin, ray.tmax, shade, pending);
      if (shade.blocked) best.t = -INFINITY;
    } else {
      consider_nearest_corners(corners, triangle, s, ray.tmin, best, pending);
    }
  }
  if (asks_materials()) wait_for_material(ray, pending, best, shade);
}

// Leaves of the node at work: for all rays one after the other, or each ray its own, which costs about 1.7 times as
// much a triangle.
void test_leaves(uint leaves, uint own, Ray ray, Shear s, inout Nearest best, inout Shade shade, inout Tests tests) {
  bool apart = 1.7 * max_lanes(float(bitCount(own))) < float(bitCount(leaves));
  uint todo = apart ? own : leaves;
  while (apart ? any_lane(todo != 0u) : todo != 0u) {
    bool has = todo != 0u;
    uint slot = has ? lowest_bit(todo) : 0u, leaf;
    if (apart)
      leaf = own_child(slot);
    else
      leaf = child_subgroup(slot);
    todo &= todo - (has ? 1u : 0u);
    uint triangle = leaf_first(leaf), last = has ? triangle + leaf_count(leaf) : triangle;
    while (apart ? any_lane(triangle < last) : triangle < last) {
      bool is_active = triangle < last;
      Corners corners;
      if (apart)
        corners = load_triangle(is_active ? triangle : 0u);
      else
        corners = load_triangle_subgroup(triangle);
      test_triangle(corners, triangle, is_active, ray, s, best, shade, tests);
      ++triangle;
    }
  }
}

// The children of a node that a ray enters, a bit each.
uint entered_by(Boxes boxes, Ray ray, Shear s, float farthest) {
  vec3 lo, hi;
  child_box(boxes, gl_SubgroupInvocationID & 7u, lo, hi);
  vec3 upper_lo = vec3(0), upper_hi = vec3(0);
  if (LANES < 8u) child_box(boxes, 4u + (gl_SubgroupInvocationID & 3u), upper_lo, upper_hi);
  uint entered = 0u;
  [[unroll]] for (uint c = 0u; c < WIDE; ++c) {
    bool upper = LANES < 8u && c >= 4u;
    uint lane = upper ? c - 4u : c;
    vec2 range =
        slab(s, subgroupBroadcast(upper ? upper_lo : lo, lane), subgroupBroadcast(upper ? upper_hi : hi, lane));
    entered |= range.x <= range.y && range.y >= ray.tmin && range.x <= farthest ? 1u << c : 0u;
  }
  return entered & boxes.grid.present;
}

// A node's step pays where more than LEAST_ENTERING of eight rays enter some child; what the better steps saved, worse
// ones may spend.
const int LEAST_ENTERING = 3, MOST_SAVED = 16;

// Where the rays part, `w` is where each goes on alone, which it is not otherwise.
void walk_packet(Ray ray, Shear s, inout Walk w, inout Nearest best, inout Shade shade, inout Tests tests) {
  w.visit.octant = subgroupBroadcast(w.visit.octant, 0u);
  uint node = 0u;
  int saved = MOST_SAVED;
  while (node != CHILD_EMPTY && saved >= 0) {
    uint entered = entered_by(load_boxes_subgroup(node), ray, s, best.t);
    if (best.t > -INFINITY) tests.boxes += WIDE;
    uint alike = or_lanes(entered | (entered != 0u ? 256u << gl_SubgroupInvocationID : 0u)), some = alike & 255u;
    hold_children(node);
    uint leaves = some & leaf_children();
    visit_children_subgroup(w.visit, node, some & ~leaves);
    if (leaves != 0u) {
      test_leaves(leaves, entered & leaves, ray, s, best, shade, tests);
      if (ANY_HIT && !any_lane(best.t > -INFINITY)) break;
    }
    saved = min(saved + int(8u * bitCount(alike >> 8) / LANES) - LEAST_ENTERING, MOST_SAVED);
    node = next_child_subgroup(w.visit);
  }
  if (asks_materials()) settle_all(ray, best, shade);
  w.current = node == CHILD_EMPTY || !(best.t > -INFINITY) ? CHILD_EMPTY : node;
  if (any_lane(w.current != CHILD_EMPTY)) unspread_stack(w.visit);
}
#endif
