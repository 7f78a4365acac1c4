// SPDX-License-Identifier: MIT
// First include of every kernel: extensions, the shared header, global indices.
#ifndef SHEAF_COMMON_GLSL
#define SHEAF_COMMON_GLSL
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#extension GL_EXT_shader_atomic_int64 : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_EXT_control_flow_attributes : require
#ifdef COMPUTE
#extension GL_KHR_shader_subgroup_basic : require
#endif
#include "interface/bindings.h"
#include "interface/dispatch.h"
#include "interface/types.h"

#define BUFFER(role, access, type, name) \
  layout(scalar, set = 0, binding = role) access buffer Block_##name { type name[]; }

#ifdef COMPUTE
#include "interface/remap_workgroup.h"
layout(local_size_x = 64, local_size_x_id = SPEC_GROUP) in;
// Threads of a CPU device, to which it deals workgroups; 0: another device.
layout(constant_id = SPEC_WORKERS) const uint WORKERS = 0;
const uint LONGEST_TURN = 6u;  // 64 workgroups, log2

// Workgroups past 32768 are folded into y by the host.
uint group_count() { return gl_NumWorkGroups.x * gl_NumWorkGroups.y; }
uint group_number() { return gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x; }

// The piece of work that is this workgroup's.
uint global_group() {
  if (WORKERS <= 1u) return group_number();
  return remap_workgroup(group_number(), group_count(), WORKERS, LONGEST_TURN);
}

// Place in the workgroup, whose size the device's subgroups divide. A CPU device finds the built-in one by dividing,
// lane by lane: 60 cycles per subgroup, where a whole kernel takes a thousand.
uint local_index() {
  return WORKERS > 0u ? gl_SubgroupID * gl_SubgroupSize + gl_SubgroupInvocationID : gl_LocalInvocationID.x;
}
uint global_index() { return global_group() * gl_WorkGroupSize.x + local_index(); }
#endif

#define INFINITY uintBitsToFloat(0x7F800000u)
#endif
