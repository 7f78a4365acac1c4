// SPDX-License-Identifier: MIT
// First include of every kernel: extensions, the shared header, global indices.
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#extension GL_EXT_shader_atomic_int64 : require
#include "shared.h"

#define BUFFER(role, access, type, name) \
  layout(scalar, set = 0, binding = role) access buffer Block_##name { type name[]; }

#ifdef COMPUTE
layout(local_size_x = 64, local_size_x_id = SPEC_GROUP) in;

// Workgroups past 32768 are folded into y by the host.
uint global_group() { return gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x; }
uint global_index() { return global_group() * gl_WorkGroupSize.x + gl_LocalInvocationID.x; }
#endif

#define INFINITY uintBitsToFloat(0x7F800000u)
