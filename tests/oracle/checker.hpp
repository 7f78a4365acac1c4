// SPDX-License-Identifier: MIT
// Every ray of a batch against Embree, every reported hit against double precision, every disagreement (and a sample of
// the rest) against all triangles in extended precision.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "embree_tracer.hpp"

namespace oracle {

enum class Verdict : std::uint8_t {
  same,           // as Embree
  tie,            // another triangle at the same t, within both bounds
  free,           // the ray passes an outline, or ends, within the bounds: either answer is right
  embree,         // Embree is wrong: the engine's hit is sure, and Embree has none or one behind it
  missed,         // from here on the engine is wrong: a miss where a hit is sure
  false_hit,      // a hit outside its triangle, or outside the ray's range
  wrong_t,        // right triangle, t off by more than the bound
  wrong_nearest,  // a hit behind a sure one
  bad_ray,        // a ray that is none: not finite, without direction
};
constexpr std::size_t verdict_count = 9;
const char* name_of(Verdict verdict);
constexpr bool is_failure(Verdict verdict) { return verdict >= Verdict::missed; }

struct Disagreement {
  std::uint64_t ray;
  Verdict verdict;
  Hit engine, embree;
};

struct Tally {
  std::uint64_t rays = 0, hits = 0, sampled = 0;
  std::array<std::uint64_t, verdict_count> verdicts{};
  double worst_t = 0;  // error of t in units of its bound, over all hits
  std::vector<Disagreement> listed;
  [[nodiscard]] std::uint64_t failures() const;
};

struct Effort {
  std::uint64_t pairs = 20'000'000;  // ray-triangle pairs a batch that samples may cost
  std::size_t listed = 20;           // disagreements a batch and verdict to list
};

class Checker {
 public:
  Checker(std::span<const Triangle> triangles, const Effort& effort);
  /// `any`: shadow rays, whose hit may be any occluder.
  Tally check(std::span<const Ray> rays, std::span<const Hit> hits, bool any) const;

 private:
  struct Judged {
    Verdict verdict;
    double t_share;
  };
  [[nodiscard]] Judged judge_hit(const Ray& ray, const Hit& hit) const;
  [[nodiscard]] Verdict judge(const Ray& ray, const Hit& hit, const Hit& embree, bool any) const;
  [[nodiscard]] Verdict settle_behind(const Ray& ray, const Hit& hit) const;

  std::span<const Triangle> triangles_;
  Effort effort_;
  EmbreeTracer embree_;
};

}  // namespace oracle
