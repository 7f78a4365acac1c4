// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// Traverse and intersect for `hybrid`: one subgroup walks the object hierarchy with a bundle of rays. Lanes are a node's
// children when boxes are tested; at a leaf they are vectors of rays (a subgroup's worth each) against its box, then the rays of
// the vectors that enter. Nodes and triangles are loaded once for all rays, a pair of words a lane.
//
// Exact: see beam.glsl; the cone test is padded. Control flow as in single_ray.glsl.
#define COMPUTE
#include "common.glsl"
#extension GL_EXT_control_flow_attributes : require
#include "rays.glsl"
#include "scene.glsl"
#include "candidate.glsl"
#include "results.glsl"
#include "lists.glsl"
#include "counting.glsl"
#include "ray_node.glsl"
#include "visit.glsl"
#include "beam.glsl"
BUFFER(ROLE_RAYS, readonly, float, rays);
BUFFER(ROLE_ORDER, readonly, uint, order);
BUFFER(ROLE_RAY_NODES, readonly, float, ray_nodes);
BUFFER(ROLE_WORK, readonly, uint, work);
layout(constant_id = 10) const uint LANES = 8;    // of a subgroup, which is the workgroup
layout(constant_id = 11) const uint VECTORS = 8;  // BUNDLE / LANES
layout(push_constant) uniform Push { uint kind; } push;
#include "lanes.glsl"

// A lane's ray of each vector.
vec3 r_origin[VECTORS], r_inverse[VECTORS], r_shear[VECTORS];
float r_tmin[VECTORS], r_t[VECTORS], r_end[VECTORS];  // r_t: nearest so far, −∞ once there is nothing more to find; r_end: far
                                                      // limit of a shadow ray, or t where it is blocked
uint r_axis[VECTORS], r_slot[VECTORS], r_triangle[VECTORS];
ivec3 r_stops[VECTORS];
Beam vector_beam;                                     // lane v: of vector v
uint lane, ray_count, first_ray;
Visit visit;                                          // the same in all lanes
uint box_tests = 0u, triangle_tests = 0u, node_tests = 0u;

#include "bundle_queue.glsl"

Extent extent_of(Extent mine) {
  return Extent(min_lanes(mine.olo), max_lanes(mine.ohi), min_lanes(mine.ilo), max_lanes(mine.ihi), min_lanes(mine.tmin));
}

Beam load_bundle() {
  [[unroll]] for (uint v = 0u; v < VECTORS; ++v) {
    r_triangle[v] = NO_INDEX;
    r_stops[v] = ivec3(0);
  }
  Extent own = Extent(vec3(INFINITY), vec3(-INFINITY), vec3(INFINITY), vec3(-INFINITY), INFINITY);
  float own_far = -INFINITY;
  [[dont_unroll]] for (uint v = 0u; v < VECTORS; ++v) {
    uint k = v * LANES + lane;
    uint slot = order[first_ray + min(k, ray_count - 1u)];  // the last one fills the rest; its extra lanes find nothing
    Ray ray = LOAD_RAY(rays, slot);
    Shear s = make_shear(ray.origin, ray.direction);
    float limit = k < ray_count ? ray.tmax : -INFINITY;
    PUT(r_origin, v, s.origin);
    PUT(r_inverse, v, s.inverse);
    PUT(r_shear, v, vec3(s.sx, s.sy, s.sz));
    PUT(r_axis, v, s.axis);
    PUT(r_tmin, v, ray.tmin);
    PUT(r_t, v, limit);
    PUT(r_end, v, ray.tmax);
    PUT(r_slot, v, slot);
    Extent e = extent_of(Extent(s.origin, s.origin, s.inverse, s.inverse, ray.tmin));
    float far = max_lanes(limit);
    if (lane == v % LANES) {
      own = e;  // with more vectors than lanes the last wins: then vector_beam is not used
      own_far = far;
      vector_beam = make_beam(e, far);
    }
    if (VECTORS > LANES) {
      own = Extent(min(own.olo, e.olo), max(own.ohi, e.ohi), min(own.ilo, e.ilo), max(own.ihi, e.ihi), min(own.tmin, e.tmin));
      own_far = max(own_far, far);
    }
  }
  if (VECTORS <= LANES && lane >= VECTORS) vector_beam.farthest = -INFINITY;
  return make_beam(extent_of(own), max_lanes(own_far));
}

// Pairs of words that all lanes want, held a pair a lane, or two where there are but four lanes.
struct Held {
  uvec2 low, high;
};

#define HELD(h, k) (LANES < 8u && (k) >= 4u ? subgroupBroadcast((h).high, (k) & 3u) : subgroupBroadcast((h).low, (k)))

Boxes load_boxes(uint node) {
  NodePairs words = node_pairs(node);
  Held h = Held(unpack32(words.pair[lane & 7u]), LANES < 8u ? unpack32(words.pair[4u + (lane & 3u)]) : uvec2(0));
  return Boxes(unpack_grid(HELD(h, 0u), HELD(h, 1u)), HELD(h, 2u), HELD(h, 3u), HELD(h, 4u), HELD(h, 5u), HELD(h, 6u), HELD(h, 7u));
}

Corners load_corners(uint triangle) {
  TrianglePairs words = triangle_pairs(triangle);
  Held h = Held(unpack32(words.pair[min(lane, 4u)]), LANES < 8u ? unpack32(words.pair[4]) : uvec2(0));
  return unpack_triangle(HELD(h, 0u), HELD(h, 1u), HELD(h, 2u), HELD(h, 3u), HELD(h, 4u));
}

// Children that some ray of the bundle may enter, a bit each.
uint entered_children(Beam beam, Cone cone, uint node) {
  Boxes boxes = load_boxes(node);
  uint entered = 0u;
  for (uint base = 0u; base < WIDE; base += LANES) {
    uint c = base + lane;
    vec3 lo, hi;
    child_box(boxes, c & 7u, lo, hi);
    bool there = c < WIDE && (boxes.grid.there & (1u << c)) != 0u;
    if (there) ++node_tests;
    bool enters = there && beam_enters(beam, lo, hi) && cone_meets_sphere(cone, 0.5 * lo + 0.5 * hi, 0.5 * length(hi - lo));
    entered |= lanes_where(enters) << base;
  }
  return entered;
}

// The rays of a vector at work.
struct Work {
  uint v;
  Shear shear;
  float tmin;
  Nearest best;  // t −∞: nothing more to find
  Shade shade;
};

void test_triangle(uint triangle, bool enters, inout Work w) {
  Corners corners = load_corners(triangle);
  Pending pending = NOTHING_PENDING;
  if (enters && w.best.t > -INFINITY) {
    ++triangle_tests;
    if (ANY_HIT) {
      consider_shadow_corners(corners, triangle, w.shear, w.tmin, w.best.t, w.shade, pending);
      if (w.shade.blocked) w.best.t = -INFINITY;
    } else {
      consider_nearest_corners(corners, triangle, w.shear, w.tmin, w.best, pending);
    }
  }
  if (asks_materials()) queue_pending(w.v, pending);
}

Work load_work(uint v) {
  Work w;
  vec3 shear;
  w.v = v;
  PICK(w.shear.origin, r_origin, v);
  PICK(w.shear.inverse, r_inverse, v);
  PICK(shear, r_shear, v);
  PICK(w.shear.axis, r_axis, v);
  PICK(w.tmin, r_tmin, v);
  PICK(w.best.t, r_t, v);
  w.shear.sx = shear.x;
  w.shear.sy = shear.y;
  w.shear.sz = shear.z;
  w.shade = Shade(false, NO_INDEX, 0.0, ivec3(0));
  w.best.triangle = NO_INDEX;
  if (!ANY_HIT) PICK(w.best.triangle, r_triangle, v);
  return w;
}

void store_work(Work w) {
  PUT(r_t, w.v, w.best.t);
  if (!ANY_HIT) {
    PUT(r_triangle, w.v, w.best.triangle);
  } else if (w.shade.blocked) {
    PUT(r_triangle, w.v, w.shade.triangle);
    PUT(r_end, w.v, w.shade.t);
  }
  float far = max_lanes(w.best.t);
  if (lane == w.v % LANES) vector_beam.farthest = far;
}

void test_vector(uint v, uint leaf, vec3 lo, vec3 hi) {
  Work w = load_work(v);
  vec2 range = slab(w.shear, lo, hi);
  bool enters = range.x <= range.y && range.y >= w.tmin && range.x <= w.best.t;
  if (v * LANES + lane < ray_count) ++box_tests;
  uint first = leaf_first(leaf), last = any_lane(enters) ? first + leaf_count(leaf) : first;
  for (uint triangle = first; triangle < last; ++triangle) test_triangle(triangle, enters, w);
  store_work(w);
}

void test_leaf(uint leaf, uint place) {
  Boxes boxes = load_boxes(place / WIDE);
  vec3 lo, hi;
  child_box(boxes, place % WIDE, lo, hi);
  uint todo = VECTORS > LANES ? (1u << VECTORS) - 1u : lanes_where(beam_enters(vector_beam, lo, hi));
  while (todo != 0u) {
    test_vector(uint(findLSB(todo)), leaf, lo, hi);
    todo &= todo - 1u;
  }
}

float farthest_hit() {
  float far = -INFINITY;
  if (VECTORS <= LANES) return max_lanes(vector_beam.farthest);
  [[unroll]] for (uint v = 0u; v < VECTORS; ++v) far = max(far, r_t[v]);
  return max_lanes(far);
}

void walk(Beam beam, Cone cone) {
  uint current = 0u, place = 0u;
  while (current != CHILD_EMPTY) {
    while (current != CHILD_EMPTY && queue_has_room()) {
      while (is_node(current)) {
        visit_children(visit, current, entered_children(beam, cone, current) & 255u);
        current = next_child(visit, place);
      }
      while (!is_node(current) && current != CHILD_EMPTY && queue_has_room()) {
        test_leaf(current, place);
        beam.farthest = farthest_hit();
        current = next_child(visit, place);
        if (!(beam.farthest > -INFINITY)) current = CHILD_EMPTY;  // every shadow ray is blocked
      }
    }
    if (asks_materials()) settle_queue();
  }
}

void store(uint v) {
  uint slot, triangle;
  float t;
  PICK(slot, r_slot, v);
  PICK(triangle, r_triangle, v);
  if (ANY_HIT)
    PICK(t, r_end, v)
  else
    PICK(t, r_t, v)
  if (v * LANES + lane >= ray_count) return;
  hits[slot] = triangle == NO_INDEX ? NO_HIT : pack_hit(t, triangle);
  if (ANY_HIT && TRANSLUCENT) {
    ivec3 sum;
    PICK(sum, r_stops, v);
    for (uint c = 0u; c < 3u; ++c) optical_depth[3u * slot + c] = sum[c];
  }
  if (PIXEL_COUNTED)
    count_pixel(floatBitsToUint(RAYS(rays, RAY_PIXEL, slot)), node_tests + (box_tests + triangle_tests) / VECTORS);
}

void main() {
  if (global_group() >= counters[COUNT_TIGHT]) return;
  uint rays_here = counters[COUNT_RAYS + push.kind];
  uint bundle = work[(rays_here + BUNDLE - 1u) / BUNDLE + global_group()];
  lane = gl_SubgroupInvocationID;
  first_ray = bundle * BUNDLE;
  ray_count = min(BUNDLE, rays_here - first_ray);
  RayNode node = LOAD_RAY_NODE(ray_nodes, bundle * RAY_NODE_WORDS);
  visit = Visit(0u, 0u, octant_of(node.axis));
  Beam beam = load_bundle();
  walk(beam, cone_of(node));
  [[dont_unroll]] for (uint v = 0u; v < VECTORS; ++v) store(v);
  count_tests(push.kind, STAT_NODE_OBJECT, node_tests);
  count_tests(push.kind, STAT_LEVELS + 3u, node_tests);
  count_tests(push.kind, STAT_RAY_BOX, box_tests);
  count_tests(push.kind, STAT_RAY_TRIANGLE, triangle_tests);
}
