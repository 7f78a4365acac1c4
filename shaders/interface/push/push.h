// SPDX-License-Identifier: MIT
// Push constants are declared once for both sides: a struct of 4-byte words per kernel or group of kernels. Members
// have no other alignment than 4 bytes, so scalar layout and the layout of C++ agree; SHEAF_PUSH checks it, and marks
// the struct as one that Recorder::dispatch takes. A shader says PUSH(NamePush) (lib/push.glsl).
#ifndef SHEAF_PUSH_H
#define SHEAF_PUSH_H
#include "interface/bindings.h"
#include "interface/types.h"

#ifdef __cplusplus
#include <type_traits>
namespace sheaf::gpu {
template <typename T>
inline constexpr bool is_push = false;
}  // namespace sheaf::gpu
#define SHEAF_PUSH(type, words)                                                       \
  static_assert(sizeof(type) == 4 * (words) && alignof(type) == 4);                   \
  static_assert(std::is_trivially_copyable_v<type> && sizeof(type) <= PUSH_LISTS);    \
  template <>                                                                         \
  inline constexpr bool is_push<type> = true;
#else
#define SHEAF_PUSH(type, words)
#endif

SHEAF_INTERFACE_BEGIN

// Of kernels that need to know only which of the lists they work on.
struct KindPush {
  uint kind;
};
SHEAF_PUSH(KindPush, 1)

// Of kernels that need nothing but the addresses of lists, or not even these.
struct NoPush {
  uint unused;
};
SHEAF_PUSH(NoPush, 1)

SHEAF_INTERFACE_END
#endif
