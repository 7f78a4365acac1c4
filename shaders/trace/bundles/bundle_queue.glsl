// SPDX-License-Identifier: MIT
// Hits of a lane's rays that a material may take back wait here: asking materials takes long, and what one lane needs
// all lanes run, so it is done for many at once.
#ifndef SHEAF_BUNDLE_QUEUE_GLSL
#define SHEAF_BUNDLE_QUEUE_GLSL
#include "lib/convert.glsl"
#include "lists/rays.glsl"
#include "scene/attributes.glsl"
#include "trace/bundles/bundle_state.glsl"
#include "trace/common/candidate.glsl"

bool is_room(uint holding, uint queueing) {
  return holding < HELD_LEAVES && (!asks_materials() || queueing + LEAF_TRIANGLES * (holding + 1u) <= QUEUE);
}

// For what one more leaf of one vector may add: itself, or hits; what waits are hits to be. Lanes are asked where what
// they may have does not tell.
bool waiting_has_room() {
  if (is_room(bundle.most_held, bundle.most_queued)) return true;
  bundle.most_held = to_uint(max_lanes(float(bundle.held)));
  if (asks_materials()) bundle.most_queued = to_uint(max_lanes(float(bundle.queued)));
  return is_room(bundle.most_held, bundle.most_queued) || !any_lane(!is_room(bundle.held, bundle.queued));
}

void queue_pending(uint v, Pending pending) {
  if (pending.triangle == NO_INDEX) return;
  bundle.queued_vector[bundle.queued] = v;
  bundle.queued_triangle[bundle.queued] = pending.triangle;
  bundle.queued_t[bundle.queued] = pending.t;
  ++bundle.queued;
}

// What is asked depends on the barycentrics: the same test once more, which gives the same bits.
void settle_one(uint v, uint triangle, float t) {
  Ray ray = load_ray(bundle.list.rays, load_slot(bundle.list.order, bundle.first_ray + v * LANES + bundle.lane));
  TriangleHit h = intersect_corners(make_shear(ray.origin, ray.direction), load_triangle(triangle), ray.tmin, ray.tmax);
  if (ANY_HIT) {
    ivec3 passed = ivec3(0);
    if (crossing(triangle, h.barycentric, ray.direction, t, ray.tmax, passed)) {
      bundle.optical_depth[v] += passed;
    } else {
      bundle.triangle[v] = triangle;
      bundle.end[v] = t;
      bundle.nearest[v] = -INFINITY;
    }
    return;
  }
  if (!(t < bundle.nearest[v] || (t == bundle.nearest[v] && triangle < bundle.triangle[v])) ||
      masked_out(triangle, h.barycentric))
    return;
  bundle.triangle[v] = triangle;
  bundle.nearest[v] = t;
}

void settle_queue() {
  for (uint e = 0u; e < bundle.queued; ++e)
    settle_one(bundle.queued_vector[e], bundle.queued_triangle[e], bundle.queued_t[e]);
  bundle.queued = bundle.most_queued = 0u;
}
#endif
