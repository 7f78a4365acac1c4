// SPDX-License-Identifier: MIT
// A node's boxes, each lane's own node. (Where all lanes want the same node: bundle_rays.glsl.)
#ifndef SHEAF_NODE_BOXES_GLSL
#define SHEAF_NODE_BOXES_GLSL
#include "scene/memory.glsl"
#include "scene/node.glsl"
Boxes load_boxes(uint node) {
  NodePairs words = node_pairs(node);
  return Boxes(unpack_grid(unpack32(words.pair[0]), unpack32(words.pair[1])), unpack32(words.pair[2]),
               unpack32(words.pair[3]), unpack32(words.pair[4]), unpack32(words.pair[5]), unpack32(words.pair[6]),
               unpack32(words.pair[7]));
}
#endif
