// SPDX-License-Identifier: MIT
#include "agreement.hpp"

#include <cmath>
#include <optional>

namespace bench {
namespace {

using Measured = oracle::Measured<double>;

// Embree runs as fast as it can, not in its robust mode: its hits are held to a multiple of the oracle's bounds, which
// are those of a watertight test.
constexpr double slack = 8;

bool is_free(const oracle::Ray& ray, const Measured& m) {
  return std::abs(m.clearance) <= slack * m.reach || std::abs(m.t - ray.tmin) <= slack * m.t_error ||
         std::abs(m.t - ray.tmax) <= slack * m.t_error;
}

bool agree_on_nearest(const oracle::Ray& ray, const std::optional<Measured>& dumped,
                      const std::optional<Measured>& embree) {
  if (!dumped && !embree) return true;
  if (dumped && embree && std::abs(dumped->t - embree->t) <= slack * (dumped->t_error + embree->t_error)) return true;
  const bool embree_first = embree && (!dumped || embree->t < dumped->t);
  return is_free(ray, embree_first ? *embree : *dumped);  // who has the farther hit, or none, passed by this outline
}

// What the filter let block the ray: the nearest is asked for again beyond every surface where light passes.
std::int32_t blocker(const EmbreeScene& scene, oracle::Ray ray) {
  Batch again{{&ray, 1}, false, {}};
  for (int crossed = 0; crossed < 64; ++crossed) {
    trace(scene, again, Method::single, 1);
    const Found& found = again.found[0];
    if (found.geometry == Found::none) return -1;
    if ((found.geometry & part_passes) == 0) return scene.triangle(found.geometry, found.primitive);
    ray.tmin = std::nextafter(found.t, ray.tmax);
  }
  return -1;
}

}  // namespace

void Agreement::add(const Agreement& other) {
  rays += other.rays;
  same += other.same;
  free += other.free;
  different += other.different;
}

Agreement compare(const EmbreeScene& scene, const Batch& batch, std::span<const oracle::Triangle> triangles,
                  std::span<const oracle::Hit> dumped) {
  Agreement result;
  result.rays = batch.rays.size();
  for (std::size_t i = 0; i < batch.rays.size(); ++i) {
    const oracle::Ray& ray = batch.rays[i];
    const Found& found = batch.found[i];
    const bool hit = found.geometry != Found::none;
    const bool both = hit == (dumped[i].triangle >= 0);
    std::int32_t embree = hit && !batch.shadow ? scene.triangle(found.geometry, found.primitive) : -1;
    if (both && (batch.shadow || embree == dumped[i].triangle)) {
      ++result.same;
      continue;
    }
    if (hit && batch.shadow) embree = blocker(scene, ray);
    auto measured = [&](std::int32_t triangle) -> std::optional<Measured> {
      if (triangle < 0) return std::nullopt;
      return oracle::measure(oracle::View<double>(ray), triangles[static_cast<std::size_t>(triangle)]);
    };
    ++(agree_on_nearest(ray, measured(dumped[i].triangle), measured(embree)) ? result.free : result.different);
  }
  return result;
}

}  // namespace bench
