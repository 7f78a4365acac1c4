// SPDX-License-Identifier: MIT
// What the headers that GLSL and C++ share are written in. Layout is scalar on both sides (vec3 = 12 bytes).
#ifndef SHEAF_INTERFACE_TYPES_H
#define SHEAF_INTERFACE_TYPES_H

#ifdef __cplusplus
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
namespace sheaf::gpu {
using uint = std::uint32_t;
using vec2 = glm::vec2;
using vec3 = glm::vec3;
using vec4 = glm::vec4;
using uvec2 = glm::uvec2;
using mat3 = glm::mat3;
}  // namespace sheaf::gpu
#define SHEAF_INTERFACE_BEGIN namespace sheaf::gpu {
#define SHEAF_INTERFACE_END }  // namespace sheaf::gpu
#define SHEAF_CONST inline constexpr uint
#define SHEAF_CONST_FLOAT inline constexpr float
#else
#extension GL_EXT_scalar_block_layout : require
#define SHEAF_INTERFACE_BEGIN
#define SHEAF_INTERFACE_END
#define SHEAF_CONST const uint
#define SHEAF_CONST_FLOAT const float
#endif

// Addresses of buffers, low word first: as two words, so that every member of a shared struct is aligned to 4 bytes on
// both sides and a CPU device need not carry 64-bit values in its lanes.
#ifdef __cplusplus
namespace sheaf::gpu {
using DeviceAddress = uvec2;
inline constexpr uint NO_INDEX = 0xFFFFFFFFu;
}  // namespace sheaf::gpu
#else
#define DeviceAddress uvec2
const uint NO_INDEX = 0xFFFFFFFFu;
#endif
#endif
