// SPDX-License-Identifier: MIT
#include "frame/reference_frames.hpp"

#include <chrono>

#include "reference/reference.hpp"
#include "stages/layers.hpp"

namespace sheaf {
namespace {

class ReferenceFrames final : public FrameSource {
 public:
  ReferenceFrames(const Scene& scene, const RenderSettings& settings)
      : scene_(scene),
        settings_(settings),
        coincidence_(std::make_shared<const Coincidence>(
            find_coincident(scene, {settings.opaque, settings.back_faces == BackFaces::show}))) {}

  RenderedFrame render(const FrameRequest& request) override {
    if (request.meanwhile) request.meanwhile();
    const auto begun = std::chrono::steady_clock::now();
    ReferenceSettings s;
    s.width = settings_.width;
    s.height = settings_.height;
    s.spp = settings_.samples.most;
    s.adaptive_error = settings_.samples.error;
    s.filter = settings_.filter;
    s.depth = settings_.depth;
    s.cutoff = settings_.cutoff;
    s.opaque = settings_.opaque;
    s.transparent_glass = settings_.glass_alpha == GlassAlpha::transparent;
    s.show_backs = settings_.back_faces == BackFaces::show;
    s.coincidence = coincidence_;
    s.stop = request.stop;
    if (settings_.environment) s.environment = glm::dvec3(*settings_.environment);
    const ReferenceFrame frame = render_reference(scene_, request.pose, request.camera, s);
    RenderedFrame out = converted(frame);
    out.stats.frame = request.number;
    out.stats.time_s = request.time_s;
    out.stats.wall_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begun).count();
    return out;
  }

 private:
  [[nodiscard]] RenderedFrame converted(const ReferenceFrame& frame) const {
    RenderedFrame out;
    FrameLayers& l = out.layers;
    l.width = frame.width;
    l.height = frame.height;
    allocate_layers(settings_.layers, l);
    for (std::size_t i = 0; i < frame.rgba.size(); ++i) {
      for (int c = 0; c < 4; ++c) l.rgba[i * 4 + c] = frame.rgba[i][c];
      if (!l.depth.empty()) l.depth[i] = frame.object[i] == 0 ? settings_.z_background : frame.depth[i];
      for (int c = 0; c < 3; ++c) {
        if (!l.normal.empty()) l.normal[i * 3 + c] = frame.normal[i][c];
        if (!l.position.empty()) l.position[i * 3 + c] = static_cast<float>(frame.position[i][c]);
        if (!l.albedo.empty()) l.albedo[i * 3 + c] = frame.albedo[i][c];
      }
      for (int c = 0; c < 2 && !l.uv.empty(); ++c) l.uv[i * 2 + c] = frame.uv[i][c];
      if (l.object_id.empty()) continue;
      l.object_id[i] = frame.object[i];
      l.material_id[i] = frame.material[i];
    }
    FrameStats& stats = out.stats;
    stats.counted = true;
    stats.strategies = {name_of(Strategy::reference)};
    stats.stopped = frame.counts.stopped;
    std::uint64_t rays = 0;
    for (std::size_t kind = 0; kind < ray_kinds; ++kind) {
      stats.rays[kind] = frame.counts.rays[kind];
      stats.hits[kind] = frame.counts.hits[kind];
      stats.ray_box[kind] = frame.counts.box_tests[kind];
      stats.ray_triangle[kind] = frame.counts.triangle_tests[kind];
      rays += frame.counts.rays[kind];
    }
    stats.brute_force = rays * frame.triangles;
    return out;
  }

  const Scene& scene_;
  RenderSettings settings_;
  std::shared_ptr<const Coincidence> coincidence_;
};

}  // namespace

std::unique_ptr<FrameSource> make_reference_frames(const Scene& scene, const RenderSettings& settings) {
  return std::make_unique<ReferenceFrames>(scene, settings);
}

}  // namespace sheaf
