// SPDX-License-Identifier: MIT
// Hits of a lane's rays that a material may take back wait here: asking materials takes long, and what one lane needs
// all lanes run, so it is done for many at once.
#ifndef SHEAF_BUNDLE_QUEUE_GLSL
#define SHEAF_BUNDLE_QUEUE_GLSL
const uint QUEUE = LEAF_TRIANGLES * (2u * HELD_LEAVES);
uint q_vector[QUEUE], q_triangle[QUEUE];
float q_t[QUEUE];
uint queued = 0u;  // of this lane

// No lane has more of either; the same in all.
uint most_held = 0u, most_queued = 0u;

bool is_room(uint holding, uint queueing) {
  return holding < HELD_LEAVES && (!asks_materials() || queueing + LEAF_TRIANGLES * (holding + 1u) <= QUEUE);
}

// For what one more leaf of one vector may add: itself, or hits; what waits are hits to be. Lanes are asked where what
// they may have does not tell.
bool waiting_has_room() {
  if (is_room(most_held, most_queued)) return true;
  most_held = to_uint(max_lanes(float(held)));
  if (asks_materials()) most_queued = to_uint(max_lanes(float(queued)));
  return is_room(most_held, most_queued) || !any_lane(!is_room(held, queued));
}

void queue_pending(uint v, Pending pending) {
  if (pending.triangle == NO_INDEX) return;
  q_vector[queued] = v;
  q_triangle[queued] = pending.triangle;
  q_t[queued] = pending.t;
  ++queued;
}

// What is asked depends on the barycentrics: the same test once more, which gives the same bits.
void settle_one(uint v, uint triangle, float t) {
  Ray ray = load_ray(push.rays, load_slot(push.order, first_ray + v * LANES + lane));
  TriangleHit h = intersect_corners(make_shear(ray.origin, ray.direction), load_triangle(triangle), ray.tmin, ray.tmax);
  if (ANY_HIT) {
    ivec3 passed = ivec3(0);
    if (crossing(triangle, h.barycentric, ray.direction, t, ray.tmax, passed)) {
      r_optical_depth[v] += passed;
    } else {
      r_triangle[v] = triangle;
      r_end[v] = t;
      r_t[v] = -INFINITY;
    }
    return;
  }
  if (!(t < r_t[v] || (t == r_t[v] && triangle < r_triangle[v])) || masked_out(triangle, h.barycentric)) return;
  r_triangle[v] = triangle;
  r_t[v] = t;
}

void settle_queue() {
  for (uint e = 0u; e < queued; ++e) settle_one(q_vector[e], q_triangle[e], q_t[e]);
  queued = most_queued = 0u;
}
#endif
