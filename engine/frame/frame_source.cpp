// SPDX-License-Identifier: MIT
#include "frame/frame_source.hpp"

#include <algorithm>

#include "frame/frame_attributes.hpp"
#include "frame/reference_frames.hpp"
#include "settings/setting.hpp"

namespace sheaf {
namespace {

class DeviceFrames final : public FrameSource {
 public:
  DeviceFrames(std::unique_ptr<Device> device, std::shared_ptr<DeviceScene> scene, const Features& features,
               const RenderSettings& settings, std::uint64_t frames)
      : device_(std::move(device)),
        still_(!features.geometry_moves() && !features.moving_camera && !features.moving_lights),
        renderer_(*device_, std::move(scene), features, settings,
                  still_ ? std::min<std::uint64_t>(frames, 1) : frames) {}

  RenderedFrame render(const FrameRequest& request) override {
    if (kept_) {  // neither geometry nor camera nor light moves: one picture for all frames
      if (request.meanwhile) request.meanwhile();
      RenderedFrame frame = *kept_;
      frame.stats.frame = request.number;
      frame.stats.time_s = request.time_s;
      frame.stats.repeated = true;
      frame.stats.wall_ms = 0;
      frame.stats.stages_ms.clear();
      return frame;
    }
    RenderedFrame frame = renderer_.render(request);
    if (still_) kept_ = frame;
    return frame;
  }
  void set_dump(DumpWriter* dump) override { renderer_.set_dump(dump); }
  void describe(RunStats& stats) const override {
    const std::string because = renderer_.chosen_because();
    stats.strategy = name_of(renderer_.strategy());
    stats.chosen_because = because.empty() ? "asked for" : because;
    stats.left_out = renderer_.plan().left_out;
    stats.scene.triangles = renderer_.scene().layout().triangles;
    stats.scene.instances = renderer_.scene().layout().instances.size();
  }

 private:
  std::unique_ptr<Device> device_;
  bool still_;
  Renderer renderer_;
  std::optional<RenderedFrame> kept_;
};

void describe(const Scene& scene, const Features& features, const RenderOptions& options, RunStats& stats) {
  stats.version = SHEAF_VERSION;
  stats.settings = settings_json(options);
  stats.scene.meshes = scene.meshes.size();
  stats.scene.materials = scene.materials.size();
  stats.scene.lights = features.default_light ? 0 : features.lights;
  stats.scene.features = features.names();
  stats.scene.extensions_read = scene.extensions_read;
  stats.scene.extensions_ignored = scene.extensions_ignored;
  stats.scene.warnings = scene.warnings;
}

}  // namespace

std::unique_ptr<FrameSource> make_frame_source(const Scene& scene, const std::vector<std::uint32_t>& animations,
                                               const RenderOptions& options, bool camera_moves, std::uint64_t frames,
                                               RunStats& stats) {
  const RenderSettings& settings = options.settings;
  const Features features = find_features(scene, animations, settings, camera_moves);
  describe(scene, features, options, stats);
  if (settings.strategy == Strategy::reference) {
    stats.device_name = "CPU, double precision";
    stats.driver = "sheaf reference " SHEAF_VERSION;
    stats.strategy = "reference";
    stats.chosen_because = "asked for";
    return make_reference_frames(scene, settings);
  }
  auto device = std::make_unique<Device>(options.device);
  stats.device_name = device->summary().name;
  stats.driver = device->summary().driver;
  const bool automatic = settings.strategy == Strategy::automatic;
  const Plan plan = make_plan(features, settings, automatic ? Strategy::bvh : settings.strategy);
  auto on_device = std::make_shared<DeviceScene>(*device, scene, settings, plan);
  auto source = std::make_unique<DeviceFrames>(std::move(device), std::move(on_device), features, settings, frames);
  source->describe(stats);
  return source;
}

}  // namespace sheaf
