// SPDX-License-Identifier: MIT
// Strategy `hybrid`: rays sorted where it pays; bundles bounded and, if tight, walked through the object hierarchy by a
// subgroup each, the rays of loose ones one a lane.
#pragma once

#include "stages/sort.hpp"
#include "stages/traverse_single.hpp"

namespace sheaf {

class TraverseBundles final : public Tracer {
 public:
  explicit TraverseBundles(const TraceContext& context);
  void trace(Recorder& recorder, const RayList& list, std::uint32_t kind, std::uint32_t generation) override;

 private:
  TraceContext context_;
  SortRays sort_;
  Kernel nearest_, any_;
  SingleKernels single_;
};

}  // namespace sheaf
