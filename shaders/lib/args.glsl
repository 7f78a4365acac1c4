// SPDX-License-Identifier: MIT
#ifndef SHEAF_ARGS_GLSL
#define SHEAF_ARGS_GLSL
#include "lib/common.glsl"
#include "lib/counters.glsl"
layout(constant_id = SPEC_BUNDLE) const uint BUNDLE_RAYS = BUNDLE;  // of `hybrid`

// Indirect dispatch arguments. Workgroups past a row are folded into y (see global_group).
BUFFER(ROLE_ARGS, coherent, uint, args);

const uint ROW = 32768u;
uvec2 folded(uint groups) { return uvec2(min(groups, ROW), (groups + ROW - 1u) / ROW); }

void set_args(uint record, uint groups) {
  uvec2 size = folded(groups);
  args[3u * record] = size.x;
  args[3u * record + 1u] = size.y;
  args[3u * record + 2u] = 1u;
}

// As many groups at least, of a record that is set: many may raise it at once.
void raise_args(uint record, uint groups) {
  uvec2 size = folded(groups);
  atomicMax(args[3u * record], size.x);
  atomicMax(args[3u * record + 1u], size.y);
}

uint groups_of(uint items, uint size) { return (items + size - 1u) / size; }

// For the list at work, once its number of rays is known.
void set_list_args(uint rays) {
  set_args(ARGS_RAYS, groups_of(rays, GROUP));
  set_args(ARGS_BLOCKS, groups_of(rays, SCAN_BLOCK));
  set_args(ARGS_BUNDLES, groups_of(rays, BUNDLE_RAYS));
  set_args(ARGS_INCOHERENT, 0u);
  counters[COUNT_INCOHERENT] = 0u;
  set_args(ARGS_ONE, min(rays, 1u));
}
#endif
