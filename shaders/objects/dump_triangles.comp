// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// Corners of the triangles from `first` on, as `--dump` writes them.
#define COMPUTE
#include "lib/common.glsl"
#include "interface/push/objects.h"
#include "lib/push.glsl"
#include "lists/rays.glsl"
#include "scene/memory.glsl"
layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer DumpCorners { vec3 corner[]; };
PUSH(DumpTrianglesPush);

void main() {
  uint i = global_index();
  if (i >= push.count) return;
  Corners v = load_triangle(push.first + i);
  DumpCorners to = DumpCorners(push.to);
  to.corner[3u * i] = v.a;
  to.corner[3u * i + 1u] = v.b;
  to.corner[3u * i + 2u] = v.c;
}
