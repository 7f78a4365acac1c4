// SPDX-License-Identifier: MIT
#include <chrono>
#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <utility>

#include "cli/commands.hpp"
#include "cli/frame_files.hpp"
#include "core/cpu_time.hpp"
#include "core/error.hpp"
#include "frame/camera_source.hpp"
#include "frame/dump_writer.hpp"
#include "frame/frame_attributes.hpp"
#include "frame/frame_source.hpp"
#include "output/atomic_file.hpp"
#include "output/png_writer.hpp"
#include "scene/gltf_loader.hpp"

namespace sheaf {
namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point begun) {
  return std::chrono::duration<double, std::milli>(Clock::now() - begun).count();
}

void make_folder(const std::string& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) throw io_error(path, error.message());
  remove_stale_parts(path);
}

std::string joined(const std::vector<std::string>& names) {
  std::string all;
  for (const auto& name : names) all += (all.empty() ? "" : ", ") + name;
  return all;
}

class Job {
 public:
  Job(RenderOptions& options, Progress& progress);
  int run();

 private:
  [[nodiscard]] FrameRequest request_for(std::int64_t number) const;
  void open_source(std::uint64_t frames);
  void render_all(const std::vector<std::int64_t>& numbers);
  void begin_writing();
  void write(RenderedFrame frame, const FrameRequest& request);
  void finish_writing();
  void save_stats(bool last);

  RenderOptions& options_;
  Progress& progress_;
  Scene scene_;
  std::vector<std::uint32_t> animations_;
  CameraSource camera_;
  double fps_;
  FrameFiles files_;
  std::unique_ptr<FrameSource> source_;
  std::unique_ptr<DumpWriter> dump_;
  RunStats stats_;
  std::uint64_t stopped_ = 0;  // rays, of all frames
  Clock::time_point saved_ = Clock::now();
  std::optional<std::pair<RenderedFrame, FrameRequest>> rendered_;  // not yet at being written
  std::future<void> writing_;  // the frame before: compressed and written while the next one renders
};

Job::Job(RenderOptions& options, Progress& progress)
    : options_(options),
      progress_(progress),
      scene_(load_gltf(options.scene, {options.scene_name, options.variant})),
      animations_(select_animations(scene_, options.animation)),
      camera_(scene_, animations_, options.camera, options.camera_node,
              static_cast<double>(options.settings.width) / options.settings.height),
      fps_(options.fps.value_or(camera_.fps().value_or(24.0))),
      files_(options, scene_, animations_, camera_, fps_) {
  if (const auto warning = compression_warning(options.compression, options.settings.layers); !warning.empty())
    progress_.warning(warning);
  for (const auto& warning : scene_.warnings) progress_.warning(options.scene + ": " + warning);
}

void Job::write(RenderedFrame frame, const FrameRequest& request) {
  const auto number = request.number;
  const auto begun = Clock::now();
  const auto path = files_.path_of(number);
  const auto attributes = frame_attributes(files_.inputs_of(number), request.camera,
                                           static_cast<double>(frame.layers.width) / frame.layers.height, fps_,
                                           joined(frame.stats.strategies));
  if (options_.preview)
    write_preview(files_.preview_of(number), frame.layers.rgba, frame.layers.width, frame.layers.height);
  write_exr(path, frame.layers, attributes, options_.compression);
  frame.stats.stages_ms.emplace_back("write", milliseconds_since(begun));
  stopped_ += frame.stats.repeated ? 0 : frame.stats.stopped;
  progress_.frame_done(number, path, frame.stats.wall_ms);
  stats_.frames.push_back(std::move(frame.stats));
}

FrameRequest Job::request_for(std::int64_t number) const {
  FrameRequest request;
  request.number = number;
  request.time_s = files_.seconds(number);
  request.pose = evaluate_pose(scene_, animations_, request.time_s);
  request.camera = camera_.at(request.pose, request.time_s);
  request.stop = [] { return interrupted() != 0; };
  return request;
}

void Job::open_source(std::uint64_t frames) {
  source_ = make_frame_source(scene_, animations_, options_, camera_.moves(), frames, stats_);
  source_->set_dump(dump_.get());
}

// While a frame renders, the next one is posed and the one before is compressed and written. Neither begins before the
// device has its work: on a CPU device all want the same cores, and whatever delays the submission leaves the others
// idle.
void Job::render_all(const std::vector<std::int64_t>& numbers) {
  const auto pose = [&](std::size_t n) {
    if (n == numbers.size()) return std::future<FrameRequest>{};
    return std::async(std::launch::async, [this, number = numbers[n]] {
      const BesideDevice beside;
      return request_for(number);
    });
  };
  auto next = pose(0);
  for (std::size_t n = 0; n < numbers.size() && interrupted() == 0; ++n) {
    FrameRequest request = next.get();
    if (!source_) open_source(numbers.size());
    request.meanwhile = [&] {
      begin_writing();
      next = pose(n + 1);
    };
    RenderedFrame frame = source_->render(request);
    request.meanwhile = nullptr;
    finish_writing();
    source_->describe(stats_);
    rendered_.emplace(std::move(frame), std::move(request));
  }
}

void Job::begin_writing() {
  if (!rendered_) return;
  writing_ = std::async(std::launch::async, [this, rendered = std::move(*rendered_)]() mutable {
    const BesideDevice beside;
    write(std::move(rendered.first), rendered.second);
  });
  rendered_.reset();
}

// Rethrows what went wrong there.
void Job::finish_writing() {
  begin_writing();
  if (!writing_.valid()) return;
  writing_.get();
  save_stats(false);
}

void Job::save_stats(bool last) {
  if (options_.stats.empty() || (!last && milliseconds_since(saved_) < 1000)) return;
  if (!last && find_write_target(options_.stats).is_stream) return;  // a stream's reader gets one document
  write_stats(options_.stats, stats_);
  saved_ = Clock::now();
}

int Job::run() {
  watch_signals();
  if (options_.list_inputs) {
    files_.list_inputs();
    return 0;
  }
  make_folder(options_.out);
  if (!options_.dump.empty()) {
    make_folder(options_.dump);
    dump_ = std::make_unique<DumpWriter>(options_.dump);
  }
  const std::vector<std::int64_t> wanted = files_.wanted(progress_);
  progress_.start(wanted.size());
  try {
    render_all(wanted);
  } catch (const Error& error) {
    finish_writing();
    if (error.kind() != ErrorKind::interrupted) throw;
  } catch (...) {
    finish_writing();  // a frame that is rendered is kept whatever became of the next
    throw;
  }
  finish_writing();
  save_stats(true);
  if (stopped_ > 0)
    progress_.warning(options_.scene + ": " + std::to_string(stopped_) +
                      " rays went through 64 blended surfaces and were stopped there: what lies behind is not seen");
  if (interrupted() != 0) {
    progress_.error(128 + interrupted(), "interrupted; whole frames are kept, --resume goes on from here");
    return 128 + interrupted();
  }
  progress_.finish();
  return 0;
}

}  // namespace

int run_render(RenderOptions& options, Progress& progress) { return Job(options, progress).run(); }

}  // namespace sheaf
