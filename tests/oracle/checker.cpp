// SPDX-License-Identifier: MIT
#include "checker.hpp"

#include <algorithm>
#include <cmath>

namespace oracle {
namespace {

bool is_finite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

bool is_bad(const Ray& ray) {
  return !is_finite(ray.origin) || !is_finite(ray.direction) || std::isnan(ray.tmin) || std::isnan(ray.tmax) ||
         std::abs(glm::length(glm::dvec3(ray.direction)) - 1) > 1e-4;
}

bool is_inside(const Ray& ray, float t) { return t >= ray.tmin && t <= ray.tmax; }

}  // namespace

const char* name_of(Verdict verdict) {
  constexpr const char* names[verdict_count] = {"same",      "tie",     "free",          "embree", "missed",
                                                "false_hit", "wrong_t", "wrong_nearest", "bad_ray"};
  return names[static_cast<std::size_t>(verdict)];
}

std::uint64_t Tally::failures() const {
  std::uint64_t sum = 0;
  for (std::size_t v = 0; v < verdict_count; ++v) sum += is_failure(static_cast<Verdict>(v)) ? verdicts[v] : 0;
  return sum;
}

Checker::Checker(std::span<const Triangle> triangles, const Effort& effort)
    : triangles_(triangles), effort_(effort), embree_(triangles) {}

/// The hit for itself: its triangle is met where it says. `same` if so.
Checker::Judged Checker::judge_hit(const Ray& ray, const Hit& hit) const {
  if (static_cast<std::size_t>(hit.triangle) >= triangles_.size() || !is_inside(ray, hit.t))
    return {Verdict::false_hit, 0};
  const auto m = measure(View<double>(ray), triangles_[static_cast<std::size_t>(hit.triangle)]);
  if (m.clearance < -m.reach) return {Verdict::false_hit, 0};
  const double share = std::abs(hit.t - m.t) / m.t_error;
  return {share <= 1 ? Verdict::same : Verdict::wrong_t, share};
}

/// Against all triangles: is one surely met before the hit (or, for a miss, before the ray's end)?
Verdict Checker::settle_behind(const Ray& ray, const Hit& hit) const {
  const Cover cover(triangles_, ray);
  if (hit.triangle < 0) return cover.blocks(ray.tmax, 0) ? Verdict::missed : Verdict::free;
  const auto m = measure(View<long double>(ray), triangles_[static_cast<std::size_t>(hit.triangle)]);
  return cover.blocks(m.t, m.t_error) ? Verdict::wrong_nearest : Verdict::free;
}

Verdict Checker::judge(const Ray& ray, const Hit& hit, const Hit& embree, bool any) const {
  if (hit.triangle < 0) return embree.triangle < 0 ? Verdict::same : settle_behind(ray, hit);
  if (embree.triangle == hit.triangle || (any && embree.triangle >= 0)) return Verdict::same;
  const View<double> view(ray);
  const auto ours = measure(view, triangles_[static_cast<std::size_t>(hit.triangle)]);
  const bool sure = ours.clearance > ours.reach && ours.t - ours.t_error > ray.tmin && ours.t + ours.t_error < ray.tmax;
  if (embree.triangle < 0) return sure ? Verdict::embree : Verdict::free;
  const auto theirs = measure(view, triangles_[static_cast<std::size_t>(embree.triangle)]);
  if (std::abs(ours.t - theirs.t) <= ours.t_error + theirs.t_error) return Verdict::tie;
  if (ours.t < theirs.t) return sure ? Verdict::embree : Verdict::free;
  return settle_behind(ray, hit);
}

Tally Checker::check(std::span<const Ray> rays, std::span<const Hit> hits, bool any) const {
  Tally tally;
  tally.rays = rays.size();
  const std::uint64_t samples =
      std::max<std::uint64_t>(16, effort_.pairs / std::max<std::size_t>(triangles_.size(), 1));
  const std::uint64_t stride = std::max<std::uint64_t>(1, rays.size() / samples);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Ray& ray = rays[i];
    const Hit& hit = hits[i];
    Hit embree{0, -1, 0, 0};
    Judged judged{Verdict::same, 0};
    tally.hits += hit.triangle >= 0 ? 1 : 0;
    if (is_bad(ray)) {
      judged.verdict = Verdict::bad_ray;
    } else {
      if (hit.triangle >= 0) judged = judge_hit(ray, hit);
      embree = embree_.nearest(ray);
      if (judged.verdict == Verdict::same) judged.verdict = judge(ray, hit, embree, any);
      if (judged.verdict == Verdict::same && i % stride == 0) {
        ++tally.sampled;
        const Verdict alone = any && hit.triangle >= 0 ? Verdict::same : settle_behind(ray, hit);
        if (is_failure(alone)) judged.verdict = alone;
      }
    }
    tally.worst_t = std::max(tally.worst_t, judged.t_share);
    const auto of_this = tally.verdicts[static_cast<std::size_t>(judged.verdict)]++;
    if (judged.verdict != Verdict::same && of_this < effort_.listed)
      tally.listed.push_back({i, judged.verdict, hit, embree});
  }
  return tally;
}

}  // namespace oracle
