// SPDX-License-Identifier: MIT
// Hits of a bundle's rays that a material may take back wait here: asking materials takes long, so it is done for many at once,
// one a lane, and the answers go to the rays they are of one after the other.
const uint LEAF_FILLS = LEAF_TRIANGLES * BUNDLE;  // the most that one leaf adds
const uint QUEUE = 2u * LEAF_FILLS;
shared uint q_ray[QUEUE], q_triangle[QUEUE];
shared float q_t[QUEUE];
uint queued = 0u;  // the same in all lanes

bool asks_materials() { return ANY_HIT ? TRANSLUCENT : MASKED; }
bool queue_has_room() { return !asks_materials() || queued <= QUEUE - LEAF_FILLS; }

// What is asked depends on the barycentrics: the same test once more, which gives the same bits.
void ask(uint e) {
  uint k = q_ray[e], triangle = q_triangle[e];
  Ray ray = LOAD_RAY(rays, order[first_ray + k]);
  TriangleHit h = intersect_corners(make_shear(ray.origin, ray.direction), load_triangle(triangle), ray.tmin, ray.tmax);
  if (!ANY_HIT) {
    if (masked_out(triangle, h.barycentric)) q_triangle[e] = NO_INDEX;
    return;
  }
  ivec3 passed = ivec3(0);
  if (!crossing(triangle, h.barycentric, ray.direction, q_t[e], ray.tmax, passed)) return;
  for (uint c = 0u; c < 3u; ++c) atomicAdd(stops[c * BUNDLE + k], passed[c]);
  q_triangle[e] = NO_INDEX;
}

void take_answer(uint e) {
  uint k = q_ray[e], v = k / LANES;
  if (k % LANES != lane || q_triangle[e] == NO_INDEX) return;
  bool takes = ANY_HIT || q_t[e] < r_t[v] || (q_t[e] == r_t[v] && q_triangle[e] < r_triangle[v]);
  if (!takes) return;
  r_triangle[v] = q_triangle[e];
  r_t[v] = ANY_HIT ? -INFINITY : q_t[e];
  if (ANY_HIT) r_end[v] = q_t[e];
}

void settle_queue() {
  sync();
  for (uint e = lane; e < queued; e += LANES) ask(e);
  sync();
  for (uint e = 0u; e < queued; ++e) take_answer(e);
  sync();
  queued = 0u;
}

void queue_pending(uint v, Pending pending) {
  uvec4 waiting = subgroupBallot(pending.triangle != NO_INDEX);
  if (pending.triangle != NO_INDEX) {
    uint at = queued + subgroupBallotExclusiveBitCount(waiting);
    q_ray[at] = v * LANES + lane;
    q_triangle[at] = pending.triangle;
    q_t[at] = pending.t;
  }
  queued += subgroupBallotBitCount(waiting);
}
