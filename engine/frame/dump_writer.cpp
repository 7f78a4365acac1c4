// SPDX-License-Identifier: MIT
#include "frame/dump_writer.hpp"

#include <array>
#include <cstdio>

#include "output/stats.hpp"

namespace sheaf {

std::string DumpWriter::name(const std::string& what) const {
  std::array<char, 32> number{};
  std::snprintf(number.data(), number.size(), "f%04lld_", static_cast<long long>(frame_));
  return folder_ + "/" + number.data() + what + ".npy";
}

void DumpWriter::begin(std::int64_t frame) {
  frame_ = frame;
  batches_.clear();
}

void DumpWriter::triangles(std::vector<float> corners, const glm::dvec3& origin) {
  write_npy(name("triangles"), std::span<const float>(corners), {corners.size() / 9, 3, 3});
  const std::array<double, 3> o{origin.x, origin.y, origin.z};
  write_npy(name("origin"), std::span<const double>(o), {3});
}

void DumpWriter::rays(std::uint32_t generation, std::uint32_t kind, const std::vector<float>& rays,
                      const std::vector<HitRecord>& hits) {
  Batch& batch = batches_[{generation, kind}];
  batch.rays.insert(batch.rays.end(), rays.begin(), rays.end());
  batch.hits.insert(batch.hits.end(), hits.begin(), hits.end());
}

void DumpWriter::mark() {
  for (auto& [key, batch] : batches_) batch.marked = batch.hits.size();
}

void DumpWriter::rewind() {
  for (auto& [key, batch] : batches_) {
    batch.hits.resize(batch.marked);
    batch.rays.resize(batch.marked * 8);
  }
}

void DumpWriter::end() {
  for (const auto& [key, batch] : batches_) {
    const std::string stem = "g" + std::to_string(key.first) + "_" + name_of(static_cast<RayKind>(key.second));
    write_npy(name(stem + "_rays"), std::span<const float>(batch.rays), {batch.hits.size(), 8});
    write_npy(name(stem + "_hits"), std::span<const HitRecord>(batch.hits));
  }
  batches_.clear();
}

}  // namespace sheaf
