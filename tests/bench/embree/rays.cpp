// SPDX-License-Identifier: MIT
#include "rays.hpp"

#include <algorithm>
#include <atomic>
#include <thread>

namespace bench {
namespace {

constexpr std::size_t chunk = 4096;  // rays a thread takes at a time
constexpr std::size_t wide = 16;
static_assert(Found::none == RTC_INVALID_GEOMETRY_ID);

RTCRay ray_of(const oracle::Ray& from) {
  RTCRay ray{};
  ray.org_x = from.origin.x;
  ray.org_y = from.origin.y;
  ray.org_z = from.origin.z;
  ray.tnear = from.tmin;
  ray.dir_x = from.direction.x;
  ray.dir_y = from.direction.y;
  ray.dir_z = from.direction.z;
  ray.tfar = from.tmax;
  ray.mask = ~0U;
  return ray;
}

void fill_lane(RTCRay16& packet, std::size_t lane, const oracle::Ray& from) {
  packet.org_x[lane] = from.origin.x;
  packet.org_y[lane] = from.origin.y;
  packet.org_z[lane] = from.origin.z;
  packet.tnear[lane] = from.tmin;
  packet.dir_x[lane] = from.direction.x;
  packet.dir_y[lane] = from.direction.y;
  packet.dir_z[lane] = from.direction.z;
  packet.tfar[lane] = from.tmax;
  packet.time[lane] = 0;
  packet.mask[lane] = ~0U;
  packet.flags[lane] = 0;
}

// Embree sets tfar to −infinity where something was hit.
Found shade_of(float tfar, unsigned crossed) { return {0, tfar < 0 ? 0 : Found::none, crossed}; }

void trace_single(const EmbreeScene& scene, Query& query, Batch& batch, std::size_t first, std::size_t last) {
  for (std::size_t i = first; i < last; ++i) {
    RTCRayHit r;
    r.ray = ray_of(batch.rays[i]);
    if (batch.shadow) {
      query.any(scene.scene(), r.ray);
      batch.found[i] = shade_of(r.ray.tfar, r.ray.flags);
      continue;
    }
    r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    r.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    query.nearest(scene.scene(), r);
    batch.found[i] = {r.ray.tfar, r.hit.geomID, r.hit.primID};
  }
}

void trace_packet(const EmbreeScene& scene, Query& query, Batch& batch, std::size_t first, std::size_t count) {
  alignas(64) int valid[wide];
  alignas(64) RTCRayHit16 r;
  for (std::size_t lane = 0; lane < wide; ++lane) {
    valid[lane] = lane < count ? -1 : 0;
    fill_lane(r.ray, lane, batch.rays[first + std::min(lane, count - 1)]);
    r.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
    r.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
  }
  if (batch.shadow)
    query.any(scene.scene(), valid, r.ray);
  else
    query.nearest(scene.scene(), valid, r);
  for (std::size_t lane = 0; lane < count; ++lane)
    batch.found[first + lane] = batch.shadow ? shade_of(r.ray.tfar[lane], r.ray.flags[lane])
                                             : Found{r.ray.tfar[lane], r.hit.geomID[lane], r.hit.primID[lane]};
}

void work(const EmbreeScene& scene, Batch& batch, Method method, std::atomic<std::size_t>& next) {
  Query query(method == Method::coherent_packet);
  for (std::size_t first; (first = next.fetch_add(chunk)) < batch.rays.size();) {
    const std::size_t last = std::min(first + chunk, batch.rays.size());
    if (method == Method::single)
      trace_single(scene, query, batch, first, last);
    else
      for (std::size_t i = first; i < last; i += wide) trace_packet(scene, query, batch, i, std::min(wide, last - i));
  }
}

}  // namespace

const char* name_of(Method method) {
  constexpr const char* names[] = {"single", "packet", "coherent_packet"};
  return names[static_cast<int>(method)];
}

Took trace(const EmbreeScene& scene, Batch& batch, Method method, unsigned threads) {
  batch.found.resize(batch.rays.size());
  std::atomic<std::size_t> next = 0;
  const Clock clock;
  {
    std::vector<std::jthread> others;
    for (unsigned t = 1; t < threads; ++t) others.emplace_back([&] { work(scene, batch, method, next); });
    work(scene, batch, method, next);
  }
  return clock.read();
}

}  // namespace bench
