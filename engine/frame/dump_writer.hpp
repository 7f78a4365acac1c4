// SPDX-License-Identifier: MIT
// `--dump`: what the engine traced, for anybody's checker. One .npy a frame, generation and kind (interface: Dump).
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "output/npy_writer.hpp"

namespace sheaf {

class DumpWriter {
 public:
  explicit DumpWriter(std::string folder) : folder_(std::move(folder)) {}

  void begin(std::int64_t frame);
  void triangles(std::vector<float> corners, const glm::dvec3& origin);  // 9 a triangle
  /// 8 floats per ray: origin, tmin, direction, tmax; one record per ray. Tiles and samples append.
  void rays(std::uint32_t generation, std::uint32_t kind, const std::vector<float>& rays,
            const std::vector<HitRecord>& hits);
  /// Forgets the rays since mark(): a tile that did not fit is traced again in parts.
  void mark();
  void rewind();
  void end();

 private:
  struct Batch {
    std::vector<float> rays;
    std::vector<HitRecord> hits;
    std::size_t marked = 0;  // rays
  };
  [[nodiscard]] std::string name(const std::string& what) const;

  std::string folder_;
  std::int64_t frame_ = 0;
  std::map<std::pair<std::uint32_t, std::uint32_t>, Batch> batches_;
};

}  // namespace sheaf
