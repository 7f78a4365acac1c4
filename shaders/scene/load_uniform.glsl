// SPDX-License-Identifier: MIT
// What all lanes of a subgroup want alike is loaded once, a pair of words per lane, or two where there are but four
// lanes, and handed round.
#ifndef SHEAF_LOAD_UNIFORM_GLSL
#define SHEAF_LOAD_UNIFORM_GLSL
#include "lib/lanes.glsl"
#include "scene/memory.glsl"
#include "scene/node.glsl"
struct Held {
  uvec2 low, high;
};

#define HELD(h, k) (LANES < 8u && (k) >= 4u ? subgroupBroadcast((h).high, (k) & 3u) : subgroupBroadcast((h).low, (k)))

Boxes load_boxes_subgroup(uint node) {
  NodePairs words = node_pairs(node);
  Held h = Held(unpack32(words.pair[gl_SubgroupInvocationID & 7u]),
                LANES < 8u ? unpack32(words.pair[4u + (gl_SubgroupInvocationID & 3u)]) : uvec2(0));
  return Boxes(unpack_grid(HELD(h, 0u), HELD(h, 1u)), HELD(h, 2u), HELD(h, 3u), HELD(h, 4u), HELD(h, 5u), HELD(h, 6u),
               HELD(h, 7u));
}

Corners load_triangle_subgroup(uint triangle) {
  if (TRANSFORM_ON_FETCH) return fetch_transformed(triangle);
  TrianglePairs words = triangle_pairs(triangle);
  Held h =
      Held(unpack32(words.pair[min(gl_SubgroupInvocationID, 4u)]), LANES < 8u ? unpack32(words.pair[4]) : uvec2(0));
  return unpack_triangle(HELD(h, 0u), HELD(h, 1u), HELD(h, 2u), HELD(h, 3u), HELD(h, 4u));
}
#endif
