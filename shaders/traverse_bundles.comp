// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// Traverse and intersect for `hybrid`: one subgroup walks the object hierarchy with a bundle of rays. Lanes are a node's
// children when boxes are tested, then rays when a leaf is: its box per ray, then its triangles. What a node or triangle costs
// to load is shared by all rays of the bundle.
//
// Exact: the bundle's slabs are interval arithmetic over the same operations as each ray's own (subtraction and
// multiplication, monotone under rounding), so no box is skipped that some ray would have entered. The cone test is padded.
#define COMPUTE
#include "common.glsl"
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_vote : require
#include "rays.glsl"
#include "scene.glsl"
#include "candidate.glsl"
#include "results.glsl"
#include "lists.glsl"
#include "counting.glsl"
#include "ray_node.glsl"
BUFFER(ROLE_RAYS, readonly, float, rays);
BUFFER(ROLE_ORDER, readonly, uint, order);
BUFFER(ROLE_NODES, readonly, float, nodes);
BUFFER(ROLE_RAY_NODES, readonly, float, ray_nodes);
BUFFER(ROLE_WORK, readonly, uint, work);
layout(constant_id = 1) const bool ANY_HIT = false;
layout(constant_id = 10) const bool CONE = true;
layout(push_constant) uniform Push { uint kind; } push;

// The bundle's rays, lane after lane; everything a test needs, so that vectors of rays load consecutively.
shared float r_ox[BUNDLE], r_oy[BUNDLE], r_oz[BUNDLE], r_ix[BUNDLE], r_iy[BUNDLE], r_iz[BUNDLE];
shared float r_sx[BUNDLE], r_sy[BUNDLE], r_sz[BUNDLE], r_tmin[BUNDLE], r_t[BUNDLE];
shared uint r_axis[BUNDLE], r_slot[BUNDLE], r_triangle[BUNDLE];
shared float r_dx[BUNDLE], r_dy[BUNDLE], r_dz[BUNDLE], r_end[BUNDLE];  // direction; far limit, or t where blocked
shared int r_stops[3 * BUNDLE];
shared uint stack[STACK_SIZE];     // node · WIDE + child
shared float entries[STACK_SIZE];
shared float child_entries[WIDE];

struct Beam {  // bounds of the bundle's rays
  vec3 olo, ohi, ilo, ihi;
  float tmin;
};

void sync() {
  subgroupMemoryBarrierShared();
  subgroupBarrier();
}

uint ray_count;
uint box_tests = 0u, triangle_tests = 0u, node_tests = 0u;

Beam load_bundle(uint bundle) {
  uint first = bundle * BUNDLE;
  ray_count = min(BUNDLE, counters[COUNT_RAYS + push.kind] - first);
  vec3 olo = vec3(INFINITY), ohi = vec3(-INFINITY), ilo = vec3(INFINITY), ihi = vec3(-INFINITY);
  float tmin = INFINITY;
  for (uint k = gl_LocalInvocationID.x; k < BUNDLE; k += gl_WorkGroupSize.x) {
    uint slot = order[first + min(k, ray_count - 1u)];  // the last one fills the rest; its extra lanes are never tested
    Ray ray = LOAD_RAY(rays, slot);
    Shear s = make_shear(ray.origin, ray.direction);
    r_ox[k] = ray.origin.x;
    r_oy[k] = ray.origin.y;
    r_oz[k] = ray.origin.z;
    r_ix[k] = s.inverse.x;
    r_iy[k] = s.inverse.y;
    r_iz[k] = s.inverse.z;
    r_sx[k] = s.sx;
    r_sy[k] = s.sy;
    r_sz[k] = s.sz;
    r_axis[k] = s.axis;
    r_tmin[k] = ray.tmin;
    r_t[k] = k < ray_count ? ray.tmax : -INFINITY;
    r_slot[k] = slot;
    r_triangle[k] = NO_INDEX;
    r_end[k] = ray.tmax;
    if (ANY_HIT && TRANSLUCENT) {
      r_dx[k] = ray.direction.x;
      r_dy[k] = ray.direction.y;
      r_dz[k] = ray.direction.z;
      for (uint c = 0u; c < 3u; ++c) r_stops[c * BUNDLE + k] = 0;
    }
    olo = min(olo, ray.origin);
    ohi = max(ohi, ray.origin);
    ilo = min(ilo, s.inverse);
    ihi = max(ihi, s.inverse);
    tmin = min(tmin, ray.tmin);
  }
  return Beam(subgroupMin(olo), subgroupMax(ohi), subgroupMin(ilo), subgroupMax(ihi), subgroupMin(tmin));
}

// Interval of one axis: least entry and greatest exit over all rays. Mixed signs bound nothing.
vec2 axis_interval(float lo, float hi, float olo, float ohi, float ilo, float ihi) {
  precise float lo_least = lo - ohi, lo_most = lo - olo, hi_least = hi - ohi, hi_most = hi - olo;
  if (ilo > 0.0) {
    precise float entry = lo_least * (lo_least >= 0.0 ? ilo : ihi);
    precise float leave = hi_most * (hi_most >= 0.0 ? ihi : ilo);
    return vec2(entry, leave);
  }
  if (ihi < 0.0) {
    precise float entry = hi_most * (hi_most >= 0.0 ? ilo : ihi);
    precise float leave = lo_least * (lo_least >= 0.0 ? ihi : ilo);
    return vec2(entry, leave);
  }
  return vec2(-INFINITY, INFINITY);
}

void child_bounds(uint node, uint c, out vec3 lo, out vec3 hi) {
  uint at = node * NODE_WORDS + c;
  lo = vec3(nodes[at], nodes[at + WIDE], nodes[at + 2u * WIDE]);
  hi = vec3(nodes[at + 3u * WIDE], nodes[at + 4u * WIDE], nodes[at + 5u * WIDE]);
}

// Entry of the bundle into a child, INFINITY where none of its rays enters.
float bundle_entry(Beam b, RayNode cone, uint node, uint c, float farthest) {
  vec3 lo, hi;
  child_bounds(node, c, lo, hi);
  vec2 x = axis_interval(lo.x, hi.x, b.olo.x, b.ohi.x, b.ilo.x, b.ihi.x);
  vec2 y = axis_interval(lo.y, hi.y, b.olo.y, b.ohi.y, b.ilo.y, b.ihi.y);
  vec2 z = axis_interval(lo.z, hi.z, b.olo.z, b.ohi.z, b.ilo.z, b.ihi.z);
  float entry = max(max(x.x, y.x), z.x), leave = min(min(x.y, y.y), z.y);
  if (!(entry <= leave && leave >= b.tmin && entry <= farthest)) return INFINITY;
  if (CONE && !node_meets_sphere(cone, 0.5 * lo + 0.5 * hi, 0.5 * length(hi - lo))) return INFINITY;
  return max(entry, b.tmin);
}

// Hits that a material may take back wait in a queue: asking materials takes long, so it is done for a full vector at a time.
const uint QUEUE = 128u;
shared uint q_ray[QUEUE], q_triangle[QUEUE];
shared float q_t[QUEUE];
uint queued = 0u;  // the same in all lanes

bool asks_materials() { return ANY_HIT ? TRANSLUCENT : MASKED; }

Shear shear_of(uint k) {
  return Shear(vec3(r_ox[k], r_oy[k], r_oz[k]), vec3(r_ix[k], r_iy[k], r_iz[k]), r_sx[k], r_sy[k], r_sz[k], r_axis[k]);
}

void settle_shadow_entry(uint e) {
  uint k = q_ray[e];
  TriangleHit h = intersect_scene_triangle(shear_of(k), q_triangle[e], r_tmin[k], r_end[k]);
  ivec3 stops = ivec3(0);
  if (crossing(q_triangle[e], h.barycentric, vec3(r_dx[k], r_dy[k], r_dz[k]), q_t[e], r_end[k], stops)) {
    for (uint c = 0u; c < 3u; ++c) atomicAdd(r_stops[c * BUNDLE + k], stops[c]);
  } else {
    r_triangle[k] = q_triangle[e];
    r_t[k] = -INFINITY;
  }
}

void settle_queue() {
  if (queued == 0u) return;
  sync();
  for (uint e = gl_LocalInvocationID.x; e < queued; e += gl_WorkGroupSize.x) {
    if (ANY_HIT) {
      settle_shadow_entry(e);
      continue;
    }
    uint k = q_ray[e];
    TriangleHit h = intersect_scene_triangle(shear_of(k), q_triangle[e], r_tmin[k], INFINITY);
    if (masked_out(q_triangle[e], h.barycentric)) q_triangle[e] = NO_INDEX;
  }
  sync();
  if (!ANY_HIT)
    for (uint e = 0u; e < queued; ++e) {  // one after the other: several may be of one ray
      uint k = q_ray[e];
      bool nearer = q_triangle[e] != NO_INDEX && (q_t[e] < r_t[k] || (q_t[e] == r_t[k] && q_triangle[e] < r_triangle[k]));
      sync();
      if (nearer && gl_LocalInvocationID.x == 0u) {
        r_t[k] = q_t[e];
        r_triangle[k] = q_triangle[e];
      }
      sync();
    }
  queued = 0u;
}

void queue_pending(uint k, Pending pending) {
  uvec4 waiting = subgroupBallot(pending.triangle != NO_INDEX);
  uint count = subgroupBallotBitCount(waiting);
  if (pending.triangle != NO_INDEX) {
    uint at = queued + subgroupBallotExclusiveBitCount(waiting);
    q_ray[at] = k;
    q_triangle[at] = pending.triangle;
    q_t[at] = pending.t;
  }
  queued += count;
  if (queued + gl_WorkGroupSize.x > QUEUE) settle_queue();
}

void test_vector(uint k, uint child, vec3 lo, vec3 hi) {
  Shear s = shear_of(k);
  float tmin = r_tmin[k];
  vec2 range = slab(s.origin, s.inverse, lo, hi);
  bool enters = range.x <= range.y && range.y >= tmin && range.x <= r_t[k];
  if (k < ray_count) ++box_tests;
  if (!subgroupAny(enters)) return;
  uint first = child & 0x07FFFFFFu, count = ((child >> 27) & 15u) + 1u;
  for (uint i = first; i < first + count; ++i) {
    float t = r_t[k];
    Pending pending = NOTHING_PENDING;
    if (enters && t > -INFINITY) {
      ++triangle_tests;
      if (ANY_HIT) {
        Shade shade = Shade(false, NO_INDEX, 0.0, ivec3(0));
        consider_shadow(i, s, tmin, t, shade, pending);
        if (shade.blocked) {
          r_triangle[k] = i;
          r_end[k] = shade.t;
          r_t[k] = -INFINITY;  // nothing more to find
        }
      } else {
        Nearest best = Nearest(t, r_triangle[k]);
        consider_nearest(i, s, tmin, best, pending);
        r_t[k] = best.t;
        r_triangle[k] = best.triangle;
      }
    }
    if (asks_materials()) queue_pending(k, pending);
  }
}

float farthest_hit() {
  float t = -INFINITY;
  for (uint k = gl_LocalInvocationID.x; k < BUNDLE; k += gl_WorkGroupSize.x) t = max(t, r_t[k]);
  return subgroupMax(t);
}

// Entered children go on the stack, the farthest first, so that the nearest is popped next.
uint push_children(Beam beam, RayNode cone, uint node, float farthest, uint depth) {
  for (uint c = gl_LocalInvocationID.x; c < WIDE; c += gl_WorkGroupSize.x) {
    uint child = floatBitsToUint(nodes[node * NODE_WORDS + NODE_CHILD + c]);
    float entry = INFINITY;
    if (child != CHILD_EMPTY) {
      entry = bundle_entry(beam, cone, node, c, farthest);
      ++node_tests;
    }
    child_entries[c] = entry;
  }
  sync();
  uint entered = 0u;
  for (uint c = 0u; c < WIDE; ++c) entered += child_entries[c] < INFINITY ? 1u : 0u;
  for (uint c = gl_LocalInvocationID.x; c < WIDE; c += gl_WorkGroupSize.x) {
    float own = child_entries[c];
    if (!(own < INFINITY)) continue;
    uint place = 0u;
    for (uint other = 0u; other < WIDE; ++other) {
      float entry = child_entries[other];
      if (entry < INFINITY && (entry > own || (entry == own && other > c))) ++place;
    }
    stack[depth + place] = node * WIDE + c;
    entries[depth + place] = own;
  }
  sync();
  return depth + entered;
}

void walk(Beam beam, RayNode cone) {
  float farthest = farthest_hit();
  uint depth = push_children(beam, cone, 0u, farthest, 0u);
  while (depth > 0u) {
    --depth;
    uint from = stack[depth];
    float entry = entries[depth];
    if (!(entry <= farthest)) continue;
    uint node = from / WIDE, c = from % WIDE;
    uint child = floatBitsToUint(nodes[node * NODE_WORDS + NODE_CHILD + c]);
    if ((child & CHILD_LEAF) == 0u) {
      depth = push_children(beam, cone, child, farthest, depth);
      continue;
    }
    vec3 lo, hi;
    child_bounds(node, c, lo, hi);
    for (uint k = gl_LocalInvocationID.x; k < BUNDLE; k += gl_WorkGroupSize.x) test_vector(k, child, lo, hi);
    farthest = farthest_hit();
    if (ANY_HIT && !(farthest > -INFINITY)) break;  // every ray is blocked
  }
  if (asks_materials()) settle_queue();
}

void main() {
  if (global_group() >= counters[COUNT_TIGHT]) return;
  uint bundles = (counters[COUNT_RAYS + push.kind] + BUNDLE - 1u) / BUNDLE;
  uint bundle = work[bundles + global_group()];
  Beam beam = load_bundle(bundle);
  RayNode cone = LOAD_RAY_NODE(ray_nodes, bundle * RAY_NODE_WORDS);
  sync();
  walk(beam, cone);
  sync();
  for (uint k = gl_LocalInvocationID.x; k < ray_count; k += gl_WorkGroupSize.x) {
    uint slot = r_slot[k];
    hits[slot] = r_triangle[k] == NO_INDEX ? NO_HIT : pack_hit(ANY_HIT ? r_end[k] : r_t[k], r_triangle[k]);
    if (ANY_HIT && TRANSLUCENT)
      for (uint c = 0u; c < 3u; ++c) optical_depth[3u * slot + c] = r_stops[c * BUNDLE + k];
    if (PIXEL_COUNTED)
      count_pixel(floatBitsToUint(RAYS(rays, RAY_PIXEL, slot)), node_tests + (box_tests + triangle_tests) / max(ray_count / gl_WorkGroupSize.x, 1u));
  }
  count_tests(push.kind, STAT_NODE_OBJECT, node_tests);
  count_tests(push.kind, STAT_LEVELS + 3u, node_tests);
  count_tests(push.kind, STAT_RAY_BOX, box_tests);
  count_tests(push.kind, STAT_RAY_TRIANGLE, triangle_tests);
}
