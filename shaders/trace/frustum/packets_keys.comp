// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// What the rays of a packet have in common: dominant axis and sign, a cell of directions, and, of sorted rays, the
// leading bits of the hash of the list as it now stands (S: the re-ordered rays are compressed once more). Rays that
// part would have a frustum that meets half the scene: where few rays share the leading bits, off spheres, packets of
// three tested 6000 nodes a ray.
#define COMPUTE
#include "lib/common.glsl"
#include "interface/push/cells.h"
#include "lib/push.glsl"
#include "lists/rays.glsl"
#include "lib/counters.glsl"
#include "scene/triangle.glsl"
#include "trace/cells/frustum.glsl"
BUFFER(ROLE_KEYS, readonly, uint, keys);
BUFFER(ROLE_PACKET_KEYS, writeonly, uint, packet_keys);
PUSH(PacketsKeysPush);

// Directions' cells along an edge of the cube of them: of a sixteenth and a quarter of a radian. Shadow rays of a
// packet begin at one lamp.
const uint CELLS = 32u, SHADOW_CELLS = 8u;

void main() {
  uint i = global_index();
  if (i >= counters[COUNT_RAYS + push.kind]) return;
  vec3 d = load_ray(ray_list.rays, load_slot(ray_list.order, i)).direction;
  uint leading = push.dropped < 32u ? keys[i] >> push.dropped : 0u;
  uint face = face_of(d);
  vec3 along = permute(d, face / 2u);
  float cells = float(push.kind == KIND_SHADOW ? SHADOW_CELLS : CELLS);
  vec2 cell = clamp(floor((along.xy / abs(along.z) * 0.5 + 0.5) * cells), vec2(0), vec2(cells - 1.0));
  // Bits that are lost above join packets, never axes or directions.
  packet_keys[i] = ((leading * CELLS + to_uint(cell.x)) * CELLS + to_uint(cell.y)) * 8u + face;
}
