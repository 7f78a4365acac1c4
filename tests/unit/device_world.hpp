// SPDX-License-Identifier: MIT
// A scene on the device with everything that tracing a list of rays needs: the engine's own classes, driven by a test
// in the order in which the renderer drives them.
#pragma once

#include <algorithm>
#include <cstring>

#include "device_fixture.hpp"
#include "scene_builder.hpp"
#include "stages/animate.hpp"
#include "stages/compact.hpp"
#include "stages/objects.hpp"
#include "stages/tracer.hpp"

namespace sheaf::test {

struct WorldOptions {
  Strategy strategy = Strategy::bvh;
  SortPolicy sort = SortPolicy::on;
  std::uint32_t capacity = 1;  // rays of a list
  std::uint64_t memory_mib = 1024;
  bool traces = true;  // false: only lists and what sorts them
};

struct Corners {
  glm::vec3 a, b, c;
};

class DeviceWorld {
 public:
  DeviceWorld(const SceneBuilder& builder, const WorldOptions& options)
      : scene_source_(builder.scene),
        settings_(settings_for(options)),
        features_(find_features(scene_source_, {}, settings_, false)),
        plan_(plan_for(options)),
        recorder_(device()),
        scene_(device(), scene_source_, settings_, plan_),
        memory_(make_ray_memory(device(), settings_, plan_, features_, 1)),
        context_{device(), scene_, memory_, plan_, features_, settings_, options.strategy, true},
        compact_(device()) {
    if (options.traces) tracer_ = make_tracer(context_);
    const Motion motion = scene_.update(builder.pose, CameraView{}, recorder_);
    bind();
    const Animate animate(device(), plan_, scene_.layout());
    const Objects objects(device(), plan_);
    animate.record(recorder_, scene_, motion);
    objects.record(recorder_, scene_, motion);
    if (tracer_) tracer_->objects_moved(recorder_, motion);
    recorder_.submit_and_wait();
  }

  [[nodiscard]] Recorder& recorder() { return recorder_; }
  [[nodiscard]] const RayMemory& memory() const { return memory_; }
  [[nodiscard]] const TraceContext& context() const { return context_; }
  [[nodiscard]] const DeviceScene& scene() const { return scene_; }
  [[nodiscard]] const RayList& list(std::uint32_t kind) const {
    return kind == gpu::KIND_SHADOW ? memory_.shadow : memory_.reflection[1];
  }

  /// As the device has them, in its order: the numbers that hits name.
  std::vector<Corners> triangles() {
    const std::uint32_t n = scene_.triangles();
    const auto words = read<float>(recorder_, scene_.triangle_words(), std::size_t{n} * gpu::TRIANGLE_WORDS);
    std::vector<Corners> result(n);
    for (std::uint32_t t = 0; t < n; ++t) std::memcpy(&result[t], &words[t * gpu::TRIANGLE_WORDS], sizeof(Corners));
    return result;
  }

  /// Rays into slots, slots into a list.
  void load(std::uint32_t kind, const std::vector<TestRay>& rays) {
    const auto count = static_cast<std::uint32_t>(rays.size());
    bind();
    const RayList& to = list(kind);
    write(recorder_, to.rays, pack_rays(rays, memory_.capacity));
    recorder_.fill(memory_.stats, 0);
    recorder_.fill(memory_.counters, 0);
    recorder_.fill(memory_.counters, count, (gpu::COUNT_SLOTS + kind) * 4ULL, 4);
    recorder_.fill(to.hits, 0xABABABABU);
    if (to.optical_depth) recorder_.fill(to.optical_depth, 0);
    compact_.record_all(recorder_, to, kind, count);
  }

  /// What the strategy leaves in the slots: t and triangle, or ~0.
  std::vector<std::uint64_t> trace(std::uint32_t kind, const std::vector<TestRay>& rays) {
    load(kind, rays);
    tracer_->trace(recorder_, list(kind), kind, 1);
    return read<std::uint64_t>(recorder_, list(kind).hits, rays.size());
  }

  std::uint64_t stat(std::uint32_t kind, std::uint32_t field) {
    return read<std::uint64_t>(recorder_, memory_.stats, gpu::STAT_SUMS)[kind * gpu::STAT_FIELDS + field];
  }

 private:
  static RenderSettings settings_for(const WorldOptions& options) {
    RenderSettings settings;
    settings.width = std::max(options.capacity, 1U);
    settings.height = 1;
    settings.strategy = options.strategy;
    settings.sort = options.sort;
    settings.memory_mib = options.memory_mib;
    settings.back_faces = BackFaces::show;  // worlds are soups: a triangle has no outside
    return settings;
  }
  [[nodiscard]] Plan plan_for(const WorldOptions& options) const {
    Plan plan = make_plan(features_, settings_, options.strategy);
    plan.reflections = plan.shadows = true;
    return plan;
  }

  void bind() {
    gpu::Frame frame{};
    frame.capacity = memory_.capacity;
    frame.lights = scene_.lights();
    frame.triangles = scene_.triangles();
    frame.instances = static_cast<std::uint32_t>(scene_.layout().instances.size());
    frame.box_pad = scene_.box_pad();
    scene_.set_addresses(frame);
    recorder_.update(memory_.frame, &frame, sizeof(frame));
    scene_.bind(recorder_);
    recorder_.bind(ROLE_FRAME, memory_.frame);
    recorder_.bind(ROLE_COUNTERS, memory_.counters);
    recorder_.bind(ROLE_ARGS, memory_.args);
    recorder_.bind(ROLE_BLOCK_SUMS, memory_.block_sums);
    recorder_.bind(ROLE_STATS, memory_.stats);
  }

  Scene scene_source_;
  RenderSettings settings_;
  Features features_;
  Plan plan_;
  Recorder recorder_;
  DeviceScene scene_;
  RayMemory memory_;
  TraceContext context_;
  Compact compact_;
  std::unique_ptr<Tracer> tracer_;
};

}  // namespace sheaf::test
