// SPDX-License-Identifier: MIT
#include "reference/reference.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <mutex>
#include <thread>

#include "core/error.hpp"
#include "reference/whitted.hpp"
#include "sampling/adaptive_pixels.hpp"

namespace sheaf {
namespace {

using namespace reference;

class Renderer {
 public:
  Renderer(const Scene& scene, const Pose& pose, const CameraView& view, const ReferenceSettings& settings,
           std::uint32_t threads)
      : view_(view),
        settings_(settings),
        world_(build_world(scene, pose, glm::dvec3(view.to_world[3]), *settings.coincidence)),
        tracer_(world_.triangles, threads),
        surfaces_(scene, world_, settings.opaque, settings.show_backs),
        places_(pixel_samples(settings.filter, settings.spp)),
        whitted_(tracer_, surfaces_, world_lights(scene, pose, view, world_.origin),
                 settings.environment.value_or(glm::dvec3(has_lights(scene) ? 0.0 : 0.4)), settings) {
    frame_.width = settings.width;
    frame_.height = settings.height;
    frame_.origin = world_.origin;
    frame_.triangles = world_.triangles.size();
    const std::size_t pixels = std::size_t{settings.width} * settings.height;
    frame_.rgba.assign(pixels, glm::vec4(0));
    frame_.depth.assign(pixels, std::numeric_limits<float>::infinity());
    frame_.normal.assign(pixels, glm::vec3(0));
    frame_.position.assign(pixels, glm::dvec3(0));
    frame_.albedo.assign(pixels, glm::vec3(0));
    frame_.uv.assign(pixels, glm::vec2(0));
    frame_.object.assign(pixels, 0);
    frame_.material.assign(pixels, 0);
    frame_.triangle.assign(pixels, none);
  }

  ReferenceFrame render(std::uint32_t threads) {
    if (settings_.adaptive_error)
      adaptive_.emplace(settings_.width, settings_.height, *settings_.adaptive_error, settings_.spp);
    do round(threads);
    while (adaptive_ && adaptive_->next_round());
    for (std::size_t i = 0; adaptive_ && i < frame_.rgba.size(); ++i) frame_.rgba[i] = glm::vec4(adaptive_->mean(i));
    return std::move(frame_);
  }

 private:
  void round(std::uint32_t threads) {
    next_row_ = 0;
    std::vector<std::jthread> helpers;
    for (std::uint32_t i = 1; i < threads; ++i) helpers.emplace_back([this] { rows(); });
    rows();
    helpers.clear();
    if (failure_) std::rethrow_exception(failure_);
    if (stopped()) throw Error(ErrorKind::interrupted, "reference: interrupted");
  }

  [[nodiscard]] bool stopped() const { return settings_.stop && settings_.stop(); }

  void rows() try {
    ReferenceCounts counts;
    for (std::uint32_t y; (y = next_row_.fetch_add(1)) < settings_.height && !stopped();) {
      for (std::uint32_t x = 0; x < settings_.width; ++x) pixel(x, y, counts);
    }
    const std::scoped_lock lock(mutex_);
    frame_.counts.stopped += counts.stopped;
    for (std::size_t k = 0; k < counts.rays.size(); ++k) {
      frame_.counts.rays[k] += counts.rays[k];
      frame_.counts.hits[k] += counts.hits[k];
      frame_.counts.box_tests[k] += counts.box_tests[k];
      frame_.counts.triangle_tests[k] += counts.triangle_tests[k];
    }
  } catch (...) {
    const std::scoped_lock lock(mutex_);
    failure_ = std::current_exception();
    next_row_ = settings_.height;
  }

  void pixel(std::uint32_t x, std::uint32_t y, ReferenceCounts& counts) {
    const std::size_t at = std::size_t{y} * settings_.width + x;
    if (adaptive_ && !adaptive_->active(at)) return;
    const std::uint32_t first = adaptive_ ? adaptive_->first_sample() : 0;
    const std::uint32_t count = adaptive_ ? adaptive_->samples() : settings_.spp;
    glm::dvec4 sum(0);
    for (std::uint32_t s = first; s < first + count; ++s) {
      const Radiance radiance = traced(glm::dvec2(x, y) + places_[s], counts);
      sum += glm::dvec4(radiance.color, radiance.alpha);
    }
    if (adaptive_)
      adaptive_->add(at, sum);
    else
      frame_.rgba[at] = glm::vec4(sum / static_cast<double>(settings_.spp));
    if (first != 0) return;
    const Ray centre = camera_ray(glm::dvec2(x, y) + 0.5);
    Tests unused;
    const Hit hit = tracer_.closest(
        centre, [&](Hit& h) { return surfaces_.seen(h, centre); }, unused);
    if (hit.triangle != none) layers(at, centre, hit);
  }

  [[nodiscard]] Radiance traced(const glm::dvec2& at, ReferenceCounts& counts) const {
    const double half = view_.orthographic ? view_.half_height : view_.tan_half_y;
    const double samples = adaptive_ ? 2 * AdaptivePixels::first_round : settings_.spp;
    const double share =
        2 * half / settings_.height / std::sqrt(samples);  // a sample stands for its share of the pixel
    return whitted_.trace(camera_ray(at), view_.orthographic ? share : 0, view_.orthographic ? 0 : share, counts);
  }

  [[nodiscard]] Ray camera_ray(const glm::dvec2& at) const {
    const double width = settings_.width, height = settings_.height, aspect = width / height;
    const double sx = 2 * at.x / width - 1, sy = 1 - 2 * at.y / height;
    const glm::dmat3 turn(view_.to_world);
    if (view_.orthographic) {
      const glm::dvec3 from(sx * view_.half_height * aspect, sy * view_.half_height, 0);
      return {turn * from, turn * glm::dvec3(0, 0, -1), view_.near, view_.far};
    }
    const glm::dvec3 way(sx * view_.tan_half_y * aspect, sy * view_.tan_half_y, -1);
    const double length = glm::length(way);  // t along the ray for a unit of depth
    return {glm::dvec3(0), glm::normalize(turn * way), view_.near * length, view_.far * length};
  }

  void layers(std::size_t at, const Ray& ray, const Hit& hit) {
    const Surface s = surfaces_.at(hit, ray.direction, 0);
    frame_.depth[at] = static_cast<float>(glm::dot(s.point, -glm::dvec3(view_.to_world[2])));
    frame_.normal[at] = s.normal;
    frame_.position[at] = s.point + world_.origin;
    frame_.albedo[at] = s.base;
    frame_.uv[at] = s.uv;
    frame_.object[at] = s.node + 1;
    frame_.material[at] = s.material + 1;
    frame_.triangle[at] = hit.triangle;
  }

  CameraView view_;
  ReferenceSettings settings_;
  World world_;
  Tracer tracer_;
  Surfaces surfaces_;
  std::vector<glm::dvec2> places_;
  Whitted whitted_;
  std::optional<AdaptivePixels> adaptive_;
  ReferenceFrame frame_;
  std::atomic<std::uint32_t> next_row_{0};
  std::mutex mutex_;
  std::exception_ptr failure_;
};

}  // namespace

ReferenceFrame render_reference(const Scene& scene, const Pose& pose, const CameraView& view,
                                const ReferenceSettings& settings) {
  if (settings.width == 0 || settings.height == 0) throw input_error("reference", "a picture without pixels");
  if (settings.spp == 0) throw input_error("reference", "no samples per pixel");
  const std::uint32_t threads =
      settings.threads != 0 ? settings.threads : std::max(1u, std::thread::hardware_concurrency());
  ReferenceSettings complete = settings;
  if (!complete.coincidence)
    complete.coincidence =
        std::make_shared<const Coincidence>(find_coincident(scene, {settings.opaque, settings.show_backs}));
  return Renderer(scene, pose, view, complete, threads).render(threads);
}

}  // namespace sheaf
