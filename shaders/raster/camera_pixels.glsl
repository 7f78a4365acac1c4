// SPDX-License-Identifier: MIT
// Which pixel of the tile the camera's ray i goes through, where each has one.
#ifndef SHEAF_CAMERA_PIXELS_GLSL
#define SHEAF_CAMERA_PIXELS_GLSL
#include "lib/frame.glsl"
#include "lib/convert.glsl"
#include "lib/curves.glsl"

// Pixels are taken block by block, along a Hilbert curve within a block, so that the rays of a vector, and all that
// follow from them, lie close together. A bijection for any size: blocks at the right and lower edges are as large as
// what is left.
uvec2 pixel_of(uint i) {
  const uint SIDE = 8u;
  uvec2 strip = divided(i, SIDE * frame.tile_width);  // which, and the place in it
  uint height = min(SIDE, frame.tile_height - SIDE * strip.x);
  uvec2 block = divided(strip.y, SIDE * height);
  uint width = min(SIDE, frame.tile_width - SIDE * block.x);
  uvec2 p = width == SIDE && height == SIDE ? on_hilbert2(block.y, 3u) : divided(block.y, width).yx;
  return SIDE * uvec2(block.x, strip.x) + p;
}
#endif
