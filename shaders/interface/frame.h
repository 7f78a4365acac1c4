// SPDX-License-Identifier: MIT
// What holds for a frame and a batch of samples.
#ifndef SHEAF_INTERFACE_FRAME_H
#define SHEAF_INTERFACE_FRAME_H
#include "interface/types.h"
SHEAF_INTERFACE_BEGIN

struct Frame {      // per frame and batch of samples
  vec3 eye;         // relative to the frame origin
  float near;
  // Camera axes, scaled by half the image plane's extent at distance 1 (perspective) or by its half extents.
  vec3 right;
  float far;
  vec3 up;
  uint orthographic;
  vec3 forward;
  float cutoff;
  vec3 environment;
  uint width;
  uint height;
  vec2 place;         // of the sample in its pixel; unused where a batch holds several samples
  uint batch_rays;    // camera rays of this batch: pixels times samples
  uint batch_samples;
  float cone_width;   // of a camera ray at its origin …
  float cone_spread;  // … and what a unit of t adds to it
  uint lights;
  uint triangles;
  uint capacity;    // slots of a ray list
  uint instances;
  uint sample_index;  // the batch's first
  float box_pad;    // what every box is widened by: 2^-21 of the largest coordinate, see triangle.glsl
  uint tile_x;
  uint tile_y;
  uint tile_width;
  uint tile_height;
  float rank_extent;  // of the surfaces that have ranks, see ranks.glsl
  uint depth;         // most bounces of a ray
  uvec2 triangles_at;  // device addresses, low word first: see memory.glsl
  uvec2 nodes_at;
  uvec2 indices_at;
  uvec2 positions_at;
  uvec2 normals_at;
  uvec2 tangents_at;
  uvec2 uvs_at;
  uvec2 colors_at;
  uvec2 dynamic_at;
  uvec2 texels_at;
  uvec2 instances_at;
  uvec2 materials_at;
  uvec2 lights_at;
  uvec2 sums_at;
};

SHEAF_INTERFACE_END
#endif
