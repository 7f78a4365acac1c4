// SPDX-License-Identifier: MIT
#include "stages/traverse_bundles.hpp"

#include <array>

#include "interface/push/trace.h"

namespace sheaf {
namespace {

// Half-angles in radians past which a bundle is not tried. A narrower one may still cross much of the scene (parallel
// rays from far apart do): it gives up after as many nodes and vectors as about half of what its rays cost alone.
// Measured on llvmpipe, 1280x720, instructions a frame against these: widths halved or five times as large within 6 %,
// efforts of 150 to 400 within 5 %.
constexpr float widest_shadow = 0.1F, widest = 0.05F;
constexpr std::uint32_t most_effort = 250;

}  // namespace

TraverseBundles::TraverseBundles(const TraceContext& c)
    : context_(c),
      incoherent_bundles_(c.device, "incoherent bundles", (std::uint64_t{c.memory.capacity} / gpu::BUNDLE + 1) * 4),
      single_(c, true) {
  if (c.plan.sorts) sort_ = SortRays(c);
  const auto lanes = lane_constants(c.device, c.device.limits().bundle);
  auto make = [&](bool any_hit) {
    auto constants = candidate_constants(c, any_hit);
    constants.insert(constants.end(), lanes.begin(), lanes.end());
    return Kernel(c.device, "traverse_bundles", constants);
  };
  nearest_ = make(false);
  if (c.plan.shadows) any_ = make(true);
}

void TraverseBundles::trace(Recorder& recorder, const RayList& list, std::uint32_t kind, std::uint32_t) {
  list.bind(recorder);
  if (context_.plan.sorts && kind != gpu::KIND_PRIMARY) sort_.record(recorder, context_, kind);

  recorder.stage("traverse");
  recorder.bind(ROLE_INCOHERENT_BUNDLES, incoherent_bundles_);
  const bool shadow = kind == gpu::KIND_SHADOW;
  const gpu::TraverseBundlesPush walk{kind, most_effort, shadow ? widest_shadow : widest};
  recorder.dispatch_indirect(shadow ? any_ : nearest_, walk, gpu::ARGS_BUNDLES);
  recorder.dispatch_indirect(shadow ? single_.any : single_.nearest, gpu::TraverseSinglePush{kind, 0, 0},
                             gpu::ARGS_INCOHERENT);
}

}  // namespace sheaf
