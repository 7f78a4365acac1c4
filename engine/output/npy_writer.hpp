// SPDX-License-Identifier: MIT
// NumPy's .npy format, version 1.0, little-endian, C order: what `--dump` writes.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace sheaf {

/// One ray's hit as dumped: dtype [('t','<f4'),('triangle','<i4'),('u','<f4'),('v','<f4')].
struct HitRecord {
  float t = 0;
  std::int32_t triangle = -1;  // -1 for a miss
  float u = 0, v = 0;
};
static_assert(sizeof(HitRecord) == 16);

using NpyShape = std::vector<std::uint64_t>;  // empty: a scalar

/// Under their names only when whole; Error{io} otherwise, Error{usage} if the shape's product is not the value count.
void write_npy(const std::string& path, std::span<const float> values, const NpyShape& shape);
void write_npy(const std::string& path, std::span<const double> values, const NpyShape& shape);
void write_npy(const std::string& path, std::span<const HitRecord> hits);  // shape (n,)

/// Magic, version, length and dictionary, padded so that the data starts at a multiple of 64 bytes.
[[nodiscard]] std::string npy_header(const std::string& descr, const NpyShape& shape);

}  // namespace sheaf
