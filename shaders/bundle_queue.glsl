// SPDX-License-Identifier: MIT
// Hits of a lane's rays that a material may take back wait here: asking materials takes long, and what one lane needs all lanes
// run, so it is done for many at once.
const uint QUEUE = LEAF_TRIANGLES * (2u * HELD_LEAVES);
uint q_vector[QUEUE], q_triangle[QUEUE];
float q_t[QUEUE];
uint queued = 0u;  // of this lane

// For what one more leaf of one vector may add: itself, or hits; what waits are hits to be.
bool waiting_has_room() {
  bool full = held == HELD_LEAVES;
  if (asks_materials()) full = full || queued + LEAF_TRIANGLES * (held + 1u) > QUEUE;
  return !any_lane(full);
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
      r_stops[v] += passed;
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
  queued = 0u;
}
