// SPDX-License-Identifier: MIT
// Indirect dispatch arguments. Workgroups past 32768 are folded into y (see global_group).
BUFFER(ROLE_ARGS, writeonly, uint, args);

void set_args(uint record, uint groups) {
  args[3u * record] = min(groups, 32768u);
  args[3u * record + 1u] = (groups + 32767u) / 32768u;
  args[3u * record + 2u] = 1u;
}

uint groups_of(uint items, uint size) { return (items + size - 1u) / size; }

// For the list at work, once its number of rays is known.
void set_list_args(uint rays) {
  set_args(ARGS_RAYS, groups_of(rays, GROUP));
  set_args(ARGS_BLOCKS, groups_of(rays, SCAN_BLOCK));
  set_args(ARGS_BUNDLES, groups_of(rays, BUNDLE));
  set_args(ARGS_BUNDLE_RUNS, groups_of(rays, BUNDLE * GROUP));
  set_args(ARGS_BUNDLE_BLOCKS, groups_of(rays, BUNDLE * SCAN_BLOCK));
  set_args(ARGS_ONE, min(rays, 1u));
}
