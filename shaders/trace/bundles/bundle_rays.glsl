// SPDX-License-Identifier: MIT
// Rays that a subgroup carries through a scene together, up to VECTORS vectors of LANES rays each. At a leaf the lanes
// are first vectors (a bound of each against the leaf's box), then the rays of the vectors that enter. Nodes and
// triangles are loaded once for all rays, a pair of words per lane.
#ifndef SHEAF_BUNDLE_RAYS_GLSL
#define SHEAF_BUNDLE_RAYS_GLSL
layout(constant_id = SPEC_LANES) const uint LANES = 8;    // of a subgroup, which is the workgroup
layout(constant_id = SPEC_VECTORS) const uint VECTORS = 8;
#include "lib/lanes.glsl"
#include "trace/bundles/bundle_bound.glsl"

// A lane's ray of each vector.
vec3 r_origin[VECTORS], r_inverse[VECTORS], r_shear[VECTORS];
// R_t: nearest so far, −∞ once there is nothing more to find; r_end: far.
float r_tmin[VECTORS], r_t[VECTORS], r_end[VECTORS];
                                                      // limit of a shadow ray, or t where it is blocked
uint r_axis[VECTORS], r_slot[VECTORS], r_triangle[VECTORS];
ivec3 r_optical_depth[VECTORS];
Beam vector_beam;                                     // lane v: of vector v
Spread spread;                                        // of the bundle
uint lane, ray_count, first_ray;
uint vectors;                                         // that hold rays
uint box_tests = 0u, triangle_tests = 0u, node_tests = 0u;
uint effort = 0u;                                     // nodes and vectors looked at; the same in all lanes

const uint HELD_LEAVES = 2u * VECTORS;
uint held = 0u;                                       // leaves that wait, of this lane (bundle_leaves.glsl)

#include "trace/bundles/bundle_queue.glsl"
#include "scene/load_uniform.glsl"

Extent extent_of(Extent mine) {
  return Extent(min_lanes(mine.olo), max_lanes(mine.ohi), min_lanes(mine.ilo), max_lanes(mine.ihi),
                min_lanes(mine.tmin));
}

Beam load_bundle() {
  [[unroll]] for (uint v = 0u; v < VECTORS; ++v) {
    r_triangle[v] = NO_INDEX;
    r_optical_depth[v] = ivec3(0);
    r_t[v] = -INFINITY;
  }
  vectors = (ray_count + LANES - 1u) / LANES;
  Extent own = Extent(vec3(INFINITY), vec3(-INFINITY), vec3(INFINITY), vec3(-INFINITY), INFINITY);
  float own_far = -INFINITY;
  vec3 dlo = vec3(2), dhi = vec3(-2), sum = vec3(0);
  float tmax = 0.0;
  [[dont_unroll]] for (uint v = 0u; v < vectors; ++v) {
    uint k = v * LANES + lane;
    // The last one fills the rest; its extra lanes find nothing.
    uint slot = load_slot(push.order, first_ray + min(k, ray_count - 1u));
    Ray ray = load_ray(push.rays, slot);
    Shear s = make_shear(ray.origin, ray.direction);
    float limit = k < ray_count ? ray.tmax : -INFINITY;
    dlo = min(dlo, ray.direction);
    dhi = max(dhi, ray.direction);
    sum += k < ray_count ? ray.direction : vec3(0);
    tmax = max(tmax, ray.tmax);
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
    if (VECTORS > LANES) {  // then vector_beam is not used
      own = Extent(min(own.olo, e.olo), max(own.ohi, e.ohi), min(own.ilo, e.ilo), max(own.ihi, e.ihi),
                   min(own.tmin, e.tmin));
      own_far = max(own_far, far);
    } else if (lane == v) {
      own = e;
      own_far = far;
      vector_beam = make_beam(e, far);
    }
  }
  if (VECTORS <= LANES && lane >= vectors) vector_beam.farthest = -INFINITY;
  Extent all = extent_of(own);
  spread = Spread(all.olo, all.ohi, min_lanes(dlo), max_lanes(dhi), sum_lanes(sum), max_lanes(tmax));
  return make_beam(all, max_lanes(own_far));
}

// The rays of a vector at work.
struct Work {
  uint v;
  Shear shear;
  float tmin;
  Nearest best;  // t −∞: nothing more to find
  Shade shade;
};

void test_corners(Corners corners, uint triangle, bool enters, inout Work w) {
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

void put_found(Work w) {
  PUT(r_t, w.v, w.best.t);
  if (!ANY_HIT) {
    PUT(r_triangle, w.v, w.best.triangle);
  } else if (w.shade.blocked) {
    PUT(r_triangle, w.v, w.shade.triangle);
    PUT(r_end, w.v, w.shade.t);
  }
}

void bound_vector(uint v, float nearest_so_far) {
  float far = max_lanes(nearest_so_far);
  if (lane == v % LANES) vector_beam.farthest = far;
}

#include "trace/bundles/bundle_leaves.glsl"

float farthest_hit() {
  float far = -INFINITY;
  if (VECTORS <= LANES) return max_lanes(vector_beam.farthest, VECTORS);
  [[unroll]] for (uint v = 0u; v < VECTORS; ++v) far = max(far, r_t[v]);
  return max_lanes(far);
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
  hit_at(push.hits, slot).v = triangle == NO_INDEX ? NO_HIT : pack_hit(t, triangle);
  if (ANY_HIT && TRANSLUCENT) {
    ivec3 sum;
    PICK(sum, r_optical_depth, v);
    for (uint c = 0u; c < 3u; ++c) optical_depth[3u * slot + c] = sum[c];
  }
  if (PIXEL_COUNTED)
    count_pixel(load_ray_pixel(push.rays, slot), node_tests + (box_tests + triangle_tests) / VECTORS);
}
#endif
