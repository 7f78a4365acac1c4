// SPDX-License-Identifier: MIT
// Which pixel of the tile the camera's ray i goes through, where each has one.
#include "curves.glsl"

// Pixels are taken block by block, along a Hilbert curve within a block, so that the rays of a vector, and all that follow from
// them, lie close together. A bijection for any size: blocks at the right and lower edges are as large as what is left.
uvec2 pixel_of(uint i) {
  const uint SIDE = 8u;
  uint strip = i / (SIDE * frame.tile_width), in_strip = i % (SIDE * frame.tile_width);
  uint height = min(SIDE, frame.tile_height - SIDE * strip);
  uint block = in_strip / (SIDE * height), in_block = in_strip % (SIDE * height);
  uint width = min(SIDE, frame.tile_width - SIDE * block);
  uvec2 p = width == SIDE && height == SIDE ? on_hilbert2(in_block, 3u) : uvec2(in_block % width, in_block / width);
  return uvec2(SIDE * block, SIDE * strip) + p;
}
