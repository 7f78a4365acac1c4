// SPDX-License-Identifier: MIT
// The other tracer: Embree, robust mode, one thread.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "truth.hpp"

namespace oracle {

class EmbreeTracer {
 public:
  explicit EmbreeTracer(std::span<const Triangle> triangles);
  ~EmbreeTracer();
  EmbreeTracer(const EmbreeTracer&) = delete;
  EmbreeTracer& operator=(const EmbreeTracer&) = delete;

  /// The nearest hit; triangle −1 for a miss.
  [[nodiscard]] Hit nearest(const Ray& ray) const;
  [[nodiscard]] static std::string version();

 private:
  struct Objects;
  std::unique_ptr<Objects> objects_;
};

}  // namespace oracle
