// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// One level of the breadth-first traversal (R 4.4): candidates (node, object) are tested sphere-and-cone against
// sphere. Candidates come from seeds (a node and a run of objects) or from the survivors of the step before, each
// opened into its node's ARITY children or its part's triangles. Survivors are marked; compaction follows.
#define COMPUTE
#include "lib/common.glsl"
#include "interface/hierarchy.h"
#include "interface/push/trace.h"
#include "lib/push.glsl"
#include "lists/rays.glsl"
#include "lib/counters.glsl"
#include "lib/counting.glsl"
#include "trace/common/ray_node.glsl"
BUFFER(ROLE_RAY_NODES, readonly, float, ray_nodes);
BUFFER(ROLE_PAIRS, writeonly, uvec2, candidates);
BUFFER(ROLE_SURVIVORS, writeonly, uint, survivors);
BUFFER(ROLE_PAIRS_NEXT, readonly, uvec2, parents);     // survivors of the step before
BUFFER(ROLE_SEEDS, readonly, uvec4, seeds);         // node, first object, candidates before, unused
BUFFER(ROLE_SPHERES, readonly, vec4, spheres);         // of instances, of parts or of triangles
BUFFER(ROLE_RUNS, readonly, uvec2, parts);             // first triangle, how many
PUSH(TraversePairsPush);

uvec2 seeded(uint i) {  // the seed whose run holds candidate i
  uint lo = 0u, hi = push.seeds - 1u;
  while (lo < hi) {
    uint middle = (lo + hi + 1u) / 2u;
    if (seeds[middle].z <= i)
      lo = middle;
    else
      hi = middle - 1u;
  }
  return uvec2(seeds[lo].x, seeds[lo].y + i - seeds[lo].z);
}

RayNode node_at(uint i) {
  if (push.level == 0u) {
    Ray r = load_ray(ray_list.rays, load_slot(ray_list.order, i));
    return RayNode(r.origin, 0.0, r.direction, 0.0, r.tmax);
  }
  return LOAD_RAY_NODE(ray_nodes, push.first_word + i * RAY_NODE_WORDS);
}

void main() {
  uint i = global_index();
  if (i >= push.candidates) return;
  uvec2 pair;
  bool exists;
  if (push.seeds != 0u) {
    pair = seeded(push.offset + i);
    exists = true;
  } else if (push.opens_parts != 0u) {
    pair = parents[push.offset + i / PART_TRIANGLES];
    uvec2 part = parts[pair.y];
    exists = i % PART_TRIANGLES < part.y;
    pair.y = part.x + i % PART_TRIANGLES;
  } else {
    pair = parents[push.offset + i / ARITY];
    pair.x = pair.x * ARITY + i % ARITY;
    exists = pair.x < push.nodes;
  }
  bool survives = false;
  if (exists) {
    vec4 s = spheres[pair.y];
    survives = node_meets_sphere(node_at(pair.x), s.xyz, s.w);
  }
  candidates[i] = pair;
  survivors[i] = survives ? 1u : 0u;
  count_tests(push.kind, STAT_NODE_OBJECT, exists ? 1u : 0u);
  count_tests(push.kind, STAT_LEVELS + min(push.level, MAX_LEVELS - 1u), exists ? 1u : 0u);
  if (PIXEL_COUNTED && exists && push.level == 0u)
    count_pixel(load_ray_pixel(ray_list.rays, load_slot(ray_list.order, pair.x)), 1u);
}
