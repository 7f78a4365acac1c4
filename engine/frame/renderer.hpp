// SPDX-License-Identifier: MIT
// The frame driver. Reads like the algorithm: animate, objects, then tile by tile raster, generate, trace, shade,
// resolve.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "device_data/device_scene.hpp"
#include "device_data/ray_lists.hpp"
#include "frame/auto_strategy.hpp"
#include "frame/list_dump.hpp"
#include "output/exr_writer.hpp"
#include "output/stats.hpp"
#include "sampling/adaptive_pixels.hpp"
#include "sampling/pixel_samples.hpp"
#include "stages/animate.hpp"
#include "stages/compact.hpp"
#include "stages/generate.hpp"
#include "stages/layers.hpp"
#include "stages/objects.hpp"
#include "stages/raster.hpp"
#include "stages/resolve.hpp"
#include "stages/shade.hpp"
#include "stages/tracer.hpp"

namespace sheaf {

struct FrameRequest {
  std::int64_t number = 0;
  double time_s = 0;
  Pose pose;
  CameraView camera;
  /// Asked between batches of samples (the reference: rows); true ends the frame with Error{interrupted}.
  std::function<bool()> stop;
  /// Called once, when the device has got work: what may run beside it may begin, and does not delay it.
  std::function<void()> meanwhile;
};

struct RenderedFrame {
  FrameLayers layers;
  FrameStats stats;
};

class Renderer {
 public:
  /// Tells the chooser of a run how many frames differ. Where the settings' strategy is a device's own, it alone is
  /// used; where it is automatic, each batch goes to whom AutoStrategy names. The reference is none of a device.
  Renderer(const Device& device, std::shared_ptr<DeviceScene> scene, const Features& features,
           const RenderSettings& settings, std::uint64_t frames);

  [[nodiscard]] RenderedFrame render(const FrameRequest& request);
  /// With the strategy now in use, or kept.
  [[nodiscard]] const Plan& plan() const { return way_->plan; }
  [[nodiscard]] Strategy strategy() const { return automatic_ ? automatic_->trial().kept() : way_->strategy; }
  /// Why that one; empty where it was asked for.
  [[nodiscard]] std::string chosen_because() const { return automatic_ ? automatic_->trial().because() : ""; }
  [[nodiscard]] const DeviceScene& scene() const { return *scene_; }
  /// Every ray traced from now on goes there too; null: no more.
  void set_dump(DumpWriter* dump);

 private:
  struct Batch {  // camera rays that go through the pipeline together
    std::uint32_t first = 0, samples = 1, rays = 0;
  };
  struct Way {  // from rays to hits
    Strategy strategy;
    Plan plan;
    std::unique_ptr<Tracer> tracer;
    bool noted = false;  // that its kernels are compiled
  };
  struct Record {  // of a list, when it had been traced
    std::uint32_t generation, kind;
    const Way* way;
    std::vector<std::uint64_t> pairs;  // Tracer::pairs_per_level
  };
  struct Spent {  // since the device was opened
    double cpu_ms = 0, stages_ms = 0, scene_ms = 0, tracing_ms = 0;
  };

  void set_frame(const CameraView& camera, const Batch& batch, const Tile& tile);
  void render_tiles(const FrameRequest& request, const Tile& tile, RenderedFrame& out);
  [[nodiscard]] bool render_tile(const FrameRequest& request, const Tile& tile, RenderedFrame& out);
  [[nodiscard]] bool render_round(const FrameRequest& request, const Tile& tile, RenderedFrame& out);
  [[nodiscard]] std::uint32_t list_active_pixels(const Tile& tile);
  void render_layers(const FrameRequest& request, const Tile& tile);
  void begin_tile(const Tile& tile);
  void finish_tile(const Tile& tile);
  /// Whether the camera's rays need not be written: what they hit lies in the visibility buffer, and nobody else asks.
  [[nodiscard]] bool direct() const { return raster_ && !layers_ && dump_ == nullptr; }
  [[nodiscard]] bool one_ray_a_pixel(std::uint32_t generation) const;
  void camera_hits(const FrameRequest& request, const Batch& batch, const Tile& tile);
  [[nodiscard]] bool render_batch(const FrameRequest& request, const Batch& batch, const Tile& tile, bool last);
  void trace(const RayList& list, std::uint32_t kind, std::uint32_t generation);
  void trace_shadows(std::uint32_t generation);
  [[nodiscard]] Way& way_of(Strategy strategy);
  void choose_way(bool frame_begins);
  [[nodiscard]] Spent spent() const;
  void note_batch(const Spent& before, const Batch& batch);
  void note_record(std::uint32_t kind, std::uint32_t generation);
  void collect_generations(RenderedFrame& out);
  void bind_all();
  void store_tile(const Tile& tile, RenderedFrame& out);
  void store_round(const Tile& tile);
  void store_adaptive(RenderedFrame& out) const;
  void store_counts(const Tile& tile, RenderedFrame& out);
  void collect_stats(RenderedFrame& out);

  const Device& device_;
  const Features features_;
  const RenderSettings settings_;
  const Plan plan_;  // of all strategies that there may be: what they share is alike
  const CompiledKernels compiled_;
  Recorder recorder_;
  std::shared_ptr<DeviceScene> scene_;
  RayMemory memory_;
  Animate animate_;
  Objects objects_;
  std::optional<Raster> raster_;
  std::optional<Layers> layers_;
  Generate generate_;
  Compact compact_;
  Shade shade_;
  Resolve resolve_;
  std::map<Strategy, Way> ways_;
  Way* way_ = nullptr;
  std::optional<AutoStrategy> automatic_;
  bool first_made_told_ = false;
  std::vector<std::string> strategies_;     // of the frame's batches
  std::uint64_t rays_seen_ = 0;             // of the tile, in the stats of its last batch
  std::vector<glm::dvec2> places_;          // of the samples in their pixel; behind them, its centre
  std::optional<AdaptivePixels> adaptive_;  // of the frame at work
  std::vector<Record> records_;             // of the tile
  DumpWriter* dump_ = nullptr;
  std::optional<ListDump> list_dump_;
};

}  // namespace sheaf
