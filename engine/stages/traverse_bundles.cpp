// SPDX-License-Identifier: MIT
#include "stages/traverse_bundles.hpp"

#include <array>

namespace sheaf {

TraverseBundles::TraverseBundles(const TraceContext& c)
    : context_(c), bundles_(c.device, "rays_hierarchy_bundles"), loose_(c.device, "loose"), single_(c, true) {
  if (c.plan.sorts) sort_ = SortRays(c);
  const std::uint32_t lanes = std::min(c.device.limits().subgroup, gpu::BUNDLE);
  auto make = [&](bool any_hit) {
    auto constants = candidate_constants(c, any_hit);
    constants.insert(constants.end(), {{0, lanes}, {10, lanes}, {11, gpu::BUNDLE / lanes}});
    return Kernel(c.device, "traverse_bundles", constants);
  };
  nearest_ = make(false);
  if (c.plan.shadows) any_ = make(true);
}

void TraverseBundles::trace(Recorder& recorder, const RayList& list, std::uint32_t kind, std::uint32_t) {
  const RayMemory& memory = context_.memory;
  list.bind(recorder);
  if (context_.plan.sorts && kind != gpu::KIND_PRIMARY) sort_.record(recorder, context_, kind);

  recorder.stage("rays_hierarchy");
  recorder.bind(ROLE_RAY_NODES, memory.ray_nodes);
  recorder.bind(ROLE_BUNDLE_FLAGS, memory.bundle_flags);
  recorder.bind(ROLE_WORK, memory.bundle_list);
  // Measured on llvmpipe: past these angles a bundle costs more than its rays would alone (see CONTRIBUTING.md).
  const struct {
    std::uint32_t kind;
    float widest;
  } push{kind, kind == gpu::KIND_SHADOW ? 0.02F : 0.04F};
  recorder.dispatch_indirect(bundles_, push, gpu::ARGS_BUNDLE_RUNS);
  loose_.record(recorder, {kind, 0, 0}, gpu::ARGS_BUNDLE_BLOCKS);

  recorder.stage("traverse");
  const bool shadow = kind == gpu::KIND_SHADOW;
  recorder.dispatch_indirect(shadow ? any_ : nearest_, kind, gpu::ARGS_TIGHT);
  recorder.dispatch_indirect(shadow ? single_.any : single_.nearest, kind, gpu::ARGS_LOOSE);
}

}  // namespace sheaf
