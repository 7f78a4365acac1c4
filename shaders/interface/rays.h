// SPDX-License-Identifier: MIT
// Rays and their lists: what a ray is, and the words in which a list holds it.
#ifndef SHEAF_INTERFACE_RAYS_H
#define SHEAF_INTERFACE_RAYS_H
#include "interface/bindings.h"
#include "interface/types.h"
SHEAF_INTERFACE_BEGIN

// Kinds of ray, in the order of the stats.
SHEAF_CONST KIND_PRIMARY = 0u;
SHEAF_CONST KIND_SHADOW = 1u;
SHEAF_CONST KIND_REFLECTION = 2u;
SHEAF_CONST KIND_REFRACTION = 3u;

// A ray's words, in pairs (rays.glsl). A list has the first RAY_PART of all its rays, then the others: tracers read no
// more than the first.
SHEAF_CONST RAY_ORIGIN = 0u;     // 3 words
SHEAF_CONST RAY_DIRECTION = 3u;  // 3 words, unit length
SHEAF_CONST RAY_TMIN = 6u;
SHEAF_CONST RAY_TMAX = 7u;
SHEAF_CONST RAY_WEIGHT = 8u;     // 3 words; a shadow ray: the light it carries if nothing is in the way
SHEAF_CONST RAY_COVERAGE = 11u;
SHEAF_CONST RAY_MEDIUM = 12u;    // stack of four volume numbers, top in the low byte; a shadow ray: its light
SHEAF_CONST RAY_PAST = 13u;      // bounces, and from bit 16 on the blended surfaces it went straight through
// Width and spread of the ray's cone, where textures are filtered (SHADING.md, Texture filter).
SHEAF_CONST RAY_CONE = 14u;
SHEAF_CONST RAY_WORDS = 16u;
SHEAF_CONST RAY_PART = 8u;
// And behind the list's rays a word each: the ray's pixel in the tile; NO_INDEX: the slot holds no ray.
SHEAF_CONST RAY_SLOT_BYTES = 4u * (RAY_WORDS + 1u);

// The parts of lists that a kernel is given, by address: those of the list at work, and the rays that generate writes.
// They lie in the push constants from byte PUSH_LISTS on, in the order of LIST_….
struct ListAddresses {
  DeviceAddress order;
  DeviceAddress hits;
  DeviceAddress rays;
  DeviceAddress shadow_rays;
  DeviceAddress reflection_rays;
  DeviceAddress refraction_rays;
};

SHEAF_INTERFACE_END

#ifdef __cplusplus
static_assert(sizeof(sheaf::gpu::ListAddresses) == 8 * LIST_COUNT);
static_assert(offsetof(sheaf::gpu::ListAddresses, hits) == 8 * LIST_HITS);
static_assert(offsetof(sheaf::gpu::ListAddresses, refraction_rays) == 8 * LIST_REFRACTION_RAYS);
#endif
#endif
