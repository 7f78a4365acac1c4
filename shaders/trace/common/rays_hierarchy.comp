// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// One level of the hierarchy over the sorted rays, bottom up, arity 4 (R 4.3). The four children are bounded at once:
// mean axis and largest angle, box centre and largest distance; tighter than three unions of pairs.
#define COMPUTE
#include "lib/common.glsl"
#include "interface/hierarchy.h"
#include "interface/push/trace.h"
#include "lib/push.glsl"
#include "lists/rays.glsl"
#include "lib/counters.glsl"
#include "trace/common/ray_node.glsl"
BUFFER(ROLE_RAY_NODES, coherent, float, ray_nodes);
PUSH(RaysHierarchyPush);

RayNode child_node(uint i) {
  if (push.level == 1u) {
    Ray r = load_ray(ray_list.rays, load_slot(ray_list.order, i));
    return RayNode(r.origin, 0.0, r.direction, 0.0, r.tmax);
  }
  return LOAD_RAY_NODE(ray_nodes, push.first_below + i * RAY_NODE_WORDS);
}

void main() {
  uint i = global_index();
  uint below = counters[COUNT_RAYS + push.kind];
  for (uint l = 1u; l < push.level; ++l) below = (below + ARITY - 1u) / ARITY;
  uint first = i * ARITY;
  if (first >= below) return;
  uint last = min(first + ARITY, below);
  vec3 lo = vec3(INFINITY), hi = vec3(-INFINITY), sum = vec3(0);
  float tmax = 0.0;
  for (uint k = first; k < last; ++k) {
    RayNode n = child_node(k);
    lo = min(lo, n.centre - n.radius);
    hi = max(hi, n.centre + n.radius);
    sum += n.axis;
    tmax = max(tmax, n.tmax);
  }
  vec3 centre = 0.5 * lo + 0.5 * hi;
  float size = length(sum);
  vec3 axis = size > 1e-3 ? sum / size : vec3(0, 0, 1);
  float radius = 0.0, angle = size > 1e-3 ? 0.0 : 4.0;
  for (uint k = first; k < last; ++k) {
    RayNode n = child_node(k);
    float distance = length(n.centre - centre);
    radius = max(radius, n.centre != centre || n.radius > 0.0 ? (distance + n.radius) * (1.0 + PAD) + LEAST : 0.0);
    angle = max(angle, angle_between(axis, n.axis) + n.angle);
  }
  uint at = push.first + i * RAY_NODE_WORDS;
  ray_nodes[at] = centre.x;
  ray_nodes[at + 1u] = centre.y;
  ray_nodes[at + 2u] = centre.z;
  ray_nodes[at + 3u] = radius;
  ray_nodes[at + 4u] = axis.x;
  ray_nodes[at + 5u] = axis.y;
  ray_nodes[at + 6u] = axis.z;
  ray_nodes[at + 7u] = angle * (1.0 + PAD) + PAD;
  ray_nodes[at + 8u] = tmax;
}
