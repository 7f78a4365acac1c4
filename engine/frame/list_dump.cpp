// SPDX-License-Identifier: MIT
#include "frame/list_dump.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>

#include "interface/push/objects.h"

namespace sheaf {
namespace {

// Of the triangles' read-back: a scene may be larger than any one buffer.
constexpr std::size_t piece = std::size_t{1} << 20U;

}  // namespace

ListDump::ListDump(const Device& device, const DeviceScene& scene, const RayMemory& memory)
    : scene_(scene), memory_(memory), ranked_(scene.layout().rank_extent > 0) {
  using Kind = Buffer::Kind;
  triangles_ = Buffer(device, "dump", std::min<std::uint64_t>(scene.triangles(), piece) * 9 * sizeof(float),
                      Kind::readback, by_address);
  rays_ = Buffer(device, "dump", std::uint64_t{memory.capacity} * gpu::RAY_SLOT_BYTES, Kind::readback, by_address);
  const std::array constants{SpecConstant{SPEC_TRANSFORM_ON_FETCH, scene.transforms_on_fetch()}};
  corners_ = Kernel(device, "dump_triangles", constants);
  hits_ = Buffer(device, "dump", std::uint64_t{memory.capacity} * 8, Kind::readback);
  order_ = Buffer(device, "dump", std::uint64_t{memory.capacity} * 4, Kind::readback);
  counters_ = Buffer(device, "dump", gpu::COUNT_WORDS * 4, Kind::readback);
}

void ListDump::triangles(Recorder& recorder, DumpWriter& writer) {
  const std::size_t count = scene_.triangles();
  host_corners_.assign(count * 9, 0);
  for (std::size_t first = 0; first < count; first += piece)
    read_triangles(recorder, first, std::min(piece, count - first));
  writer.triangles(host_corners_, scene_.origin());
}

void ListDump::read_triangles(Recorder& recorder, std::size_t first, std::size_t count) {
  const gpu::DumpTrianglesPush push{triangles_.address_words(), static_cast<std::uint32_t>(first),
                                    static_cast<std::uint32_t>(count)};
  recorder.dispatch(corners_, push, (count + gpu::GROUP - 1) / gpu::GROUP);
  recorder.submit_and_wait();
  std::copy_n(triangles_.view<float>().begin(), count * 9, &host_corners_[first * 9]);
}

// u, v as most tracers give them: P = (1 − u − v)·v0 + u·v1 + v·v2.
HitRecord ListDump::record_of(const float* ray, std::uint32_t triangle, float t) const {
  HitRecord record;
  if (triangle == gpu::NO_INDEX) return record;
  auto corner = [&](std::size_t k) {
    const float* p = &host_corners_[triangle * std::size_t{9} + k * 3];
    return glm::dvec3(p[0], p[1], p[2]);
  };
  const glm::dvec3 o(ray[0], ray[1], ray[2]), d(ray[4], ray[5], ray[6]);
  const glm::dvec3 e1 = corner(1) - corner(0), e2 = corner(2) - corner(0), s = o - corner(0);
  const glm::dvec3 p = glm::cross(d, e2), q = glm::cross(s, e1);
  const double det = glm::dot(e1, p);
  record.t =
      ranked_ && det != 0 ? static_cast<float>(glm::dot(e2, q) / det) : t;  // with ranks, t is where the hit counts
  record.triangle = static_cast<std::int32_t>(triangle);
  if (det != 0) {
    record.u = static_cast<float>(glm::dot(s, p) / det);
    record.v = static_cast<float>(glm::dot(d, q) / det);
  }
  return record;
}

void ListDump::list(Recorder& recorder, DumpWriter& writer, const RayList& list, std::uint32_t kind,
                    std::uint32_t generation, std::uint32_t slots) {
  recorder.copy(list.rays, rays_, list.rays.bytes());
  recorder.copy(list.hits, hits_, list.hits.bytes());
  recorder.copy(list.order, order_, list.order.bytes());
  recorder.copy(memory_.counters, counters_, gpu::COUNT_WORDS * 4);
  recorder.submit_and_wait();
  const std::size_t count = slots != 0 ? slots : counters_.view<std::uint32_t>()[gpu::COUNT_RAYS + kind];
  const auto words = rays_.view<float>();
  const auto found = hits_.view<glm::uvec2>();
  const auto order = order_.view<std::uint32_t>();
  std::vector<float> rays;
  std::vector<HitRecord> hits;
  rays.reserve(count * 8);
  hits.reserve(count);
  constexpr std::uint32_t fields[8] = {gpu::RAY_ORIGIN,        gpu::RAY_ORIGIN + 1, gpu::RAY_ORIGIN + 2,
                                       gpu::RAY_TMIN,          gpu::RAY_DIRECTION,  gpu::RAY_DIRECTION + 1,
                                       gpu::RAY_DIRECTION + 2, gpu::RAY_TMAX};
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t slot = slots != 0 ? i : order[i];
    for (const auto field : fields) rays.push_back(words[slot * gpu::RAY_PART + field]);
    hits.push_back(record_of(&rays[rays.size() - 8], found[slot].x, std::bit_cast<float>(found[slot].y)));
  }
  writer.rays(generation, kind, rays, hits);
}

}  // namespace sheaf
