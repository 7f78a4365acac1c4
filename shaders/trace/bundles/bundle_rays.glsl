// SPDX-License-Identifier: MIT
// Rays that a subgroup carries through a scene together, up to VECTORS vectors of LANES rays each. At a leaf the lanes
// are first vectors (a bound of each against the leaf's box), then the rays of the vectors that enter. Nodes and
// triangles are loaded once for all rays, a pair of words per lane.
#ifndef SHEAF_BUNDLE_RAYS_GLSL
#define SHEAF_BUNDLE_RAYS_GLSL
#include "lib/counting.glsl"
#include "lists/rays.glsl"
#include "scene/load_uniform.glsl"
#include "trace/bundles/bundle_queue.glsl"
#include "trace/bundles/bundle_state.glsl"
#include "trace/common/results.glsl"

Extent extent_of(Extent mine) {
  return Extent(min_lanes(mine.olo), max_lanes(mine.ohi), min_lanes(mine.ilo), max_lanes(mine.ihi),
                min_lanes(mine.tmin));
}

Beam load_bundle() {
  [[unroll]] for (uint v = 0u; v < VECTORS; ++v) {
    bundle.triangle[v] = NO_INDEX;
    bundle.optical_depth[v] = ivec3(0);
    bundle.nearest[v] = -INFINITY;
  }
  Extent own = Extent(vec3(INFINITY), vec3(-INFINITY), vec3(INFINITY), vec3(-INFINITY), INFINITY);
  float own_far = -INFINITY;
  vec3 dlo = vec3(2), dhi = vec3(-2), sum = vec3(0);
  float tmax = 0.0;
  [[dont_unroll]] for (uint v = 0u; v < bundle.vectors; ++v) {
    uint k = v * LANES + bundle.lane;
    // The last one fills the rest; its extra lanes find nothing.
    uint slot = load_slot(bundle.list.order, bundle.first_ray + min(k, bundle.ray_count - 1u));
    Ray ray = load_ray(bundle.list.rays, slot);
    Shear s = make_shear(ray.origin, ray.direction);
    float limit = k < bundle.ray_count ? ray.tmax : -INFINITY;
    dlo = min(dlo, ray.direction);
    dhi = max(dhi, ray.direction);
    sum += k < bundle.ray_count ? ray.direction : vec3(0);
    tmax = max(tmax, ray.tmax);
    PUT(bundle.origin, v, s.origin);
    PUT(bundle.inverse, v, s.inverse);
    PUT(bundle.shear, v, vec3(s.sx, s.sy, s.sz));
    PUT(bundle.axis, v, s.axis);
    PUT(bundle.tmin, v, ray.tmin);
    PUT(bundle.nearest, v, limit);
    PUT(bundle.end, v, ray.tmax);
    PUT(bundle.slot, v, slot);
    Extent e = extent_of(Extent(s.origin, s.origin, s.inverse, s.inverse, ray.tmin));
    float far = max_lanes(limit);
    if (VECTORS > LANES) {  // then vector_beam is not used
      own = Extent(min(own.olo, e.olo), max(own.ohi, e.ohi), min(own.ilo, e.ilo), max(own.ihi, e.ihi),
                   min(own.tmin, e.tmin));
      own_far = max(own_far, far);
    } else if (bundle.lane == v) {
      own = e;
      own_far = far;
      bundle.vector_beam = make_beam(e, far);
    }
  }
  if (VECTORS <= LANES && bundle.lane >= bundle.vectors) bundle.vector_beam.farthest = -INFINITY;
  Extent all = extent_of(own);
  bundle.spread = Spread(all.olo, all.ohi, min_lanes(dlo), max_lanes(dhi), sum_lanes(sum), max_lanes(tmax));
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
    ++bundle.triangle_tests;
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
  PICK(w.shear.origin, bundle.origin, v);
  PICK(w.shear.inverse, bundle.inverse, v);
  PICK(shear, bundle.shear, v);
  PICK(w.shear.axis, bundle.axis, v);
  PICK(w.tmin, bundle.tmin, v);
  PICK(w.best.t, bundle.nearest, v);
  w.shear.sx = shear.x;
  w.shear.sy = shear.y;
  w.shear.sz = shear.z;
  w.shade = Shade(false, NO_INDEX, 0.0, ivec3(0));
  w.best.triangle = NO_INDEX;
  if (!ANY_HIT) PICK(w.best.triangle, bundle.triangle, v);
  return w;
}

void put_found(Work w) {
  PUT(bundle.nearest, w.v, w.best.t);
  if (!ANY_HIT) {
    PUT(bundle.triangle, w.v, w.best.triangle);
  } else if (w.shade.blocked) {
    PUT(bundle.triangle, w.v, w.shade.triangle);
    PUT(bundle.end, w.v, w.shade.t);
  }
}

void bound_vector(uint v, float nearest_so_far) {
  float far = max_lanes(nearest_so_far);
  if (bundle.lane == v % LANES) bundle.vector_beam.farthest = far;
}

float farthest_hit() {
  float far = -INFINITY;
  if (VECTORS <= LANES) return max_lanes(bundle.vector_beam.farthest, VECTORS);
  [[unroll]] for (uint v = 0u; v < VECTORS; ++v) far = max(far, bundle.nearest[v]);
  return max_lanes(far);
}

void store(uint v) {
  uint slot, triangle;
  float t;
  PICK(slot, bundle.slot, v);
  PICK(triangle, bundle.triangle, v);
  if (ANY_HIT)
    PICK(t, bundle.end, v)
  else
    PICK(t, bundle.nearest, v)
  if (v * LANES + bundle.lane >= bundle.ray_count) return;
  hit_at(bundle.list.hits, slot).v = triangle == NO_INDEX ? NO_HIT : pack_hit(t, triangle);
  if (ANY_HIT && TRANSLUCENT) {
    ivec3 sum;
    PICK(sum, bundle.optical_depth, v);
    for (uint c = 0u; c < 3u; ++c) optical_depth[3u * slot + c] = sum[c];
  }
  if (PIXEL_COUNTED)
    count_pixel(load_ray_pixel(bundle.list.rays, slot),
                bundle.node_tests + (bundle.box_tests + bundle.triangle_tests) / VECTORS);
}
#endif
