// SPDX-License-Identifier: MIT
// Where frames come from: the device's renderer, or the double-precision reference; and frames that repeat are rendered
// once.
#pragma once

#include <memory>

#include "frame/renderer.hpp"
#include "settings/render_settings.hpp"

namespace sheaf {

class FrameSource {
 public:
  virtual ~FrameSource() = default;
  [[nodiscard]] virtual RenderedFrame render(const FrameRequest& request) = 0;
  virtual void set_dump(DumpWriter*) {}
  /// What is known after the frames so far: the strategy, why, and what was left out.
  virtual void describe(RunStats&) const {}
};

/// Opens the device (unless the strategy is `reference`) and fills in what the stats say of scene and device. `frames`:
/// how many will be asked for.
[[nodiscard]] std::unique_ptr<FrameSource> make_frame_source(const Scene& scene,
                                                             const std::vector<std::uint32_t>& animations,
                                                             const RenderOptions& options, bool camera_moves,
                                                             std::uint64_t frames, RunStats& stats);

}  // namespace sheaf
