// SPDX-License-Identifier: MIT
#include "frame/frame_source.hpp"

#include <algorithm>

#include "frame/auto_strategy.hpp"
#include "frame/reference_frames.hpp"
#include "settings/setting.hpp"

namespace sheaf {
namespace {

class DeviceFrames final : public FrameSource {
 public:
  DeviceFrames(std::unique_ptr<Device> device, std::shared_ptr<DeviceScene> scene, const Features& features,
               const RenderSettings& settings, Strategy strategy)
      : device_(std::move(device)),
        still_(!features.geometry_moves() && !features.moving_camera && !features.moving_lights),
        renderer_(*device_, std::move(scene), features, settings, strategy) {}

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
  [[nodiscard]] const Renderer& renderer() const { return renderer_; }

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
  stats.scene.extensions_ignored = scene.extensions_ignored;
  stats.scene.warnings = scene.warnings;
}

}  // namespace

std::unique_ptr<FrameSource> make_frame_source(const Scene& scene, const std::vector<std::uint32_t>& animations,
                                               const RenderOptions& options, bool camera_moves,
                                               const FrameRequest& first, RunStats& stats) {
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
  Choice choice{settings.strategy, "asked for"};
  const bool automatic = settings.strategy == Strategy::automatic;
  const Plan plan = make_plan(features, settings, automatic ? Strategy::bvh : settings.strategy);
  auto on_device = std::make_shared<DeviceScene>(*device, scene, settings, plan);
  if (automatic) choice = choose_strategy(*device, on_device, features, settings, first);
  stats.strategy = name_of(choice.strategy);
  stats.chosen_because = choice.because;
  auto frames =
      std::make_unique<DeviceFrames>(std::move(device), std::move(on_device), features, settings, choice.strategy);
  stats.left_out = frames->renderer().plan().left_out;
  stats.scene.triangles = frames->renderer().scene().layout().triangles;
  stats.scene.instances = frames->renderer().scene().layout().instances.size();
  return frames;
}

}  // namespace sheaf
