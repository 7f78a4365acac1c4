// SPDX-License-Identifier: MIT
// A batch of dumped rays through Embree: one ray per call, or packets of 16, on all cores.
#pragma once

#include <span>
#include <vector>

#include "clock.hpp"
#include "scene.hpp"

namespace bench {

enum class Method { single, packet, coherent_packet };
inline constexpr Method methods[] = {Method::single, Method::packet, Method::coherent_packet};
const char* name_of(Method method);

/// Of a ray: its nearest hit. Of a shadow ray: whether something opaque is hit (`geometry` is none or not), and how
/// many surfaces that let light pass were crossed until then (`primitive`).
struct Found {
  static constexpr unsigned none = ~0U;
  float t;
  unsigned geometry, primitive;
};

struct Batch {
  std::span<const oracle::Ray> rays;
  bool shadow;
  std::vector<Found> found;
};

/// Fills `found` and returns what it took, threads' start included. Rays are read from the dump's layout and
/// hits are written to memory, as a renderer would.
Took trace(const EmbreeScene& scene, Batch& batch, Method method, unsigned threads);

}  // namespace bench
