// SPDX-License-Identifier: MIT
// Strategy `hybrid`: rays sorted where it pays; bundles bounded and, if tight, walked through the object hierarchy by a
// subgroup each, the rays of incoherent ones one per lane.
#pragma once

#include "stages/sort.hpp"
#include "stages/traverse_single.hpp"

namespace sheaf {

class TraverseBundles final : public Tracer {
 public:
  explicit TraverseBundles(const TraceContext& context);
  void trace(Recorder& recorder, const RayList& list, std::uint32_t kind, std::uint32_t generation) override;
  [[nodiscard]] bool made() const override { return nearest_.made() && any_.made() && single_.made(); }
  [[nodiscard]] double making_ms() const override {
    return nearest_.making_ms() + any_.making_ms() + single_.making_ms();
  }

 private:
  TraceContext context_;
  Buffer incoherent_bundles_;
  SortRays sort_;
  Kernel nearest_, any_;
  SingleKernels single_;
};

}  // namespace sheaf
