// SPDX-License-Identifier: MIT
// Whether Embree found what the dump says, before any time counts.
#pragma once

#include <span>

#include "rays.hpp"

namespace bench {

/// Of one batch. `free`: the dump's or Embree's hit passes an outline within the oracle's bounds (truth.hpp), or both
/// lie at the same t within theirs. `different`: anything else.
struct Agreement {
  std::uint64_t rays = 0, same = 0, free = 0, different = 0;
  void add(const Agreement& other);
};

/// `shadow`: only whether light is blocked is compared; Embree's occluder is looked for again where the dump has none.
Agreement compare(const EmbreeScene& scene, const Batch& batch, std::span<const oracle::Triangle> triangles,
                  std::span<const oracle::Hit> dumped);

}  // namespace bench
