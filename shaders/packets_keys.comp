// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// What the rays of a packet have in common: dominant axis and sign, and, of sorted rays, the leading bits of the hash of
// the list as it now stands (S: the re-ordered rays are compressed once more).
#define COMPUTE
#include "common.glsl"
#include "rays.glsl"
#include "lists.glsl"
#include "triangle.glsl"
#include "frustum.glsl"
BUFFER(ROLE_KEYS, readonly, uint, keys);
BUFFER(ROLE_PACKET_KEYS, writeonly, uint, packet_keys);
layout(push_constant) uniform Push {
  uint kind;
  uint dropped;  // bits of the hash; 32: no hash
  PUSH_LIST
} push;

void main() {
  uint i = global_index();
  if (i >= counters[COUNT_RAYS + push.kind]) return;
  vec3 d = load_ray(push.rays, load_slot(push.order, i)).direction;
  uint leading = push.dropped < 32u ? keys[i] >> push.dropped : 0u;
  packet_keys[i] = (leading << 3) | face_of(d);  // bits that are lost above join packets, never axes
}
