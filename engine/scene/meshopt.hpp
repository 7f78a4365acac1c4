// SPDX-License-Identifier: MIT
// The codecs of EXT_meshopt_compression and KHR_meshopt_compression, from the appendices of the latter: streams of both
// versions of the attribute codec, both codecs of indices, and the filters. The distributions' libraries lack the
// second version and the colour filter, so one decoder of our own reads all of it alike everywhere.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace sheaf::meshopt {

enum class Mode { attributes, triangles, indices };
enum class Filter { none, octahedral, quaternion, exponential, color };

using In = std::span<const std::uint8_t>;
using Out = std::span<std::uint8_t>;

/// No stream of this mode that holds `count` elements is shorter: known before memory is taken for them. `count` is at
/// most 2^53, `stride` at most 256.
[[nodiscard]] std::uint64_t least_bytes(Mode mode, std::uint64_t count, std::uint64_t stride);

/// Each fills `out`, a whole number of elements (of triangles). False: the stream is damaged.
[[nodiscard]] bool decode_attributes(In stream, std::size_t stride, Out out);
[[nodiscard]] bool decode_triangles(In stream, std::size_t stride, Out out);
[[nodiscard]] bool decode_indices(In stream, std::size_t stride, Out out);

/// In place, after decode_attributes. Values that no encoder writes give some value, never a fault.
void apply_filter(Filter filter, std::size_t stride, Out elements);

inline constexpr std::uint8_t attributes_version_1 = 0xa1;  // a stream's first byte

}  // namespace sheaf::meshopt
