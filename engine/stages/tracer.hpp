// SPDX-License-Identifier: MIT
// What turns a list of rays into hits. One code path; strategies (algorithm 9) exchange its parts: whether rays are
// sorted, whether a hierarchy stands over them, and how it meets the objects. All leave the same bytes in the list's
// hits.
#pragma once

#include <memory>
#include <vector>

#include "device_data/device_scene.hpp"
#include "device_data/ray_lists.hpp"
#include "vulkan/recorder.hpp"

namespace sheaf {

struct TraceContext {
  const Device& device;
  const DeviceScene& scene;
  const RayMemory& memory;
  const Plan& plan;
  const Features& features;
  const RenderSettings& settings;
  Strategy strategy;
  bool counted;
};

/// Specialization constants of every kernel that intersects (shaders/trace/common/candidate.glsl, counting.glsl,
/// textures.glsl).
[[nodiscard]] std::vector<SpecConstant> candidate_constants(const TraceContext& context, bool any_hit);

/// Of kernels whose workgroup is a subgroup that carries so many rays at most (shaders/trace/bundles/bundle_rays.glsl,
/// lanes.glsl).
[[nodiscard]] std::vector<SpecConstant> lane_constants(const Device& device, std::uint32_t rays);

class Tracer {
 public:
  virtual ~Tracer() = default;
  /// What must be made anew after objects moved.
  virtual void objects_moved(Recorder&, const Motion&) {}
  /// The list is bound and compacted; its number of rays is on the device. Hits go to the list's slots.
  virtual void trace(Recorder& recorder, const RayList& list, std::uint32_t kind, std::uint32_t generation) = 0;
  /// Pairs of a node and an object that the last trace tested on each level, root first; none where levels are not
  /// walked one by one.
  [[nodiscard]] virtual std::vector<std::uint64_t> pairs_per_level() const { return {}; }
  /// Whether its kernels are there, so that `trace` need not wait; asked of those that `auto` tries.
  [[nodiscard]] virtual bool made() const { return true; }
  /// CPU time that making them took; waits for them.
  [[nodiscard]] virtual double making_ms() const { return 0; }
};

[[nodiscard]] std::unique_ptr<Tracer> make_tracer(const TraceContext& context);

}  // namespace sheaf
