// SPDX-License-Identifier: MIT
#include "frame/renderer.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/error.hpp"

namespace sheaf {
namespace {

constexpr std::uint32_t generations_a_submit = 4;  // between looks at whether any ray is left

}  // namespace

Renderer::Renderer(const Device& device, std::shared_ptr<DeviceScene> scene, const Features& features,
                   const RenderSettings& settings, std::uint64_t frames)
    : device_(device),
      features_(features),
      settings_(settings),
      plan_(make_plan(features, settings,
                      settings.strategy == Strategy::automatic ? Strategy::hybrid : settings.strategy)),
      compiled_(device, features, settings, plan_),
      recorder_(device),
      scene_(std::move(scene)),
      memory_(make_ray_memory(device, settings, plan_, features, scene_->lights())),
      animate_(device, plan_, scene_->layout()),
      objects_(device, plan_),
      generate_(device, plan_, features_, settings),
      compact_(device),
      shade_(device, plan_, features_, scene_->lights(), settings.counted),
      resolve_(device),
      places_(pixel_samples(settings.filter, settings.samples.most)) {
  places_.emplace_back(0.5);
  if (plan_.raster) raster_.emplace(device, plan_, features_);
  if (settings.layers.any_surface()) layers_.emplace(device, plan_, features_);
  if (memory_.sample_places) std::copy(places_.begin(), places_.end(), memory_.sample_places.view<glm::vec2>().begin());
  if (settings.strategy == Strategy::automatic) {
    const std::uint64_t pixels = std::uint64_t{settings.width} * settings.height;
    const auto tiles = static_cast<std::uint32_t>((pixels + memory_.tile_pixels - 1) / memory_.tile_pixels);
    automatic_.emplace(device_, settings_, compiled_, AutoStrategy::Run{frames, features.triangles, tiles});
  }
  way_ = &way_of(automatic_ ? automatic_->first() : settings.strategy);
}

void Renderer::bind_all() {
  scene_->bind(recorder_);
  recorder_.bind(ROLE_FRAME, memory_.frame);
  recorder_.bind(ROLE_COUNTERS, memory_.counters);
  recorder_.bind(ROLE_ARGS, memory_.args);
  recorder_.bind(ROLE_BLOCK_SUMS, memory_.block_sums);
  recorder_.bind(ROLE_STATS, memory_.stats);
  if (memory_.pixel_tests) recorder_.bind(ROLE_PIXEL_TESTS, memory_.pixel_tests);
}

void Renderer::set_frame(const CameraView& camera, const Batch& batch, const Tile& tile) {
  gpu::Frame f{};
  const double aspect = static_cast<double>(settings_.width) / settings_.height;
  const double half_y = camera.orthographic ? camera.half_height : camera.tan_half_y;
  f.eye = glm::vec3(glm::dvec3(camera.to_world[3]) - scene_->origin());
  f.right = glm::vec3(glm::dvec3(camera.to_world[0]) * (half_y * aspect));
  f.up = glm::vec3(glm::dvec3(camera.to_world[1]) * half_y);
  f.forward = glm::vec3(-glm::dvec3(camera.to_world[2]));
  f.near = static_cast<float>(std::max(camera.near, 0.0));
  f.far = static_cast<float>(camera.far);
  f.orthographic = camera.orthographic ? 1 : 0;
  f.cutoff = settings_.cutoff;
  f.environment = settings_.environment.value_or(glm::vec3(features_.default_light ? 0.4F : 0.0F));
  f.width = settings_.width;
  f.height = settings_.height;
  f.place = glm::vec2(places_[batch.first]);
  f.batch_rays = batch.rays;
  f.batch_samples = batch.samples;
  // A sample stands for its share of the pixel.
  const double share =
      2 * half_y / settings_.height / std::sqrt(adaptive_ ? 2.0 * AdaptivePixels::first_round : settings_.samples.most);
  (camera.orthographic ? f.cone_width : f.cone_spread) = static_cast<float>(share);
  f.lights = scene_->lights();
  f.triangles = scene_->triangles();
  f.capacity = memory_.capacity;
  f.instances = static_cast<std::uint32_t>(scene_->layout().instances.size());
  f.sample_index = batch.first;
  f.box_pad = scene_->box_pad();
  f.rank_extent = static_cast<float>(scene_->layout().rank_extent);
  f.depth = settings_.depth;
  f.tile_x = tile.x;
  f.tile_y = tile.y;
  f.tile_width = tile.width;
  f.tile_height = tile.height;
  scene_->set_addresses(f);
  f.sums_at = memory_.accumulation.address_words();
  recorder_.update(memory_.frame, &f, sizeof(f));
}

RenderedFrame Renderer::render(const FrameRequest& request) {
  const auto begun = std::chrono::steady_clock::now();
  RenderedFrame out;
  out.layers.width = settings_.width;
  out.layers.height = settings_.height;
  allocate_layers(settings_.layers, out.layers);
  out.stats.frame = request.number;
  out.stats.time_s = request.time_s;
  out.stats.counted = settings_.counted;

  recorder_.at_next_submit(request.meanwhile);
  const std::uint64_t dispatched = recorder_.dispatches();
  const Motion motion = scene_->update(request.pose, request.camera, recorder_);
  bind_all();
  const Tile whole{0, 0, settings_.width, settings_.height};
  set_frame(request.camera, {}, whole);
  animate_.record(recorder_, *scene_, motion);
  objects_.record(recorder_, *scene_, motion);
  strategies_.clear();
  choose_way(true);
  for (const auto& [strategy, way] : ways_) way.tracer->objects_moved(recorder_, motion);
  if (dump_ != nullptr) {
    dump_->begin(request.number);
    list_dump_->triangles(recorder_, *dump_);
  }
  if (settings_.samples.error)
    adaptive_.emplace(settings_.width, settings_.height, *settings_.samples.error, settings_.samples.most);
  do render_tiles(request, whole, out);
  while (adaptive_ && adaptive_->next_round());
  if (adaptive_) store_adaptive(out);
  if (dump_ != nullptr) dump_->end();

  const auto times = recorder_.take_times();
  for (const char* name : stage_names)
    if (const auto found = times.find(name); found != times.end())
      out.stats.stages_ms.emplace_back(name, found->second);
  out.stats.peak_device_mib = static_cast<double>(device_.peak_bytes()) / (1 << 20);
  out.stats.dispatches = recorder_.dispatches() - dispatched;
  out.stats.strategies = strategies_;
  std::uint64_t rays = 0;
  for (const auto count : out.stats.rays) rays += count;
  out.stats.brute_force = rays * scene_->triangles();
  out.stats.wall_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begun).count();
  return out;
}

void Renderer::render_tiles(const FrameRequest& request, const Tile& tile, RenderedFrame& out) {
  if (tile.pixels() <= memory_.tile_pixels && render_tile(request, tile, out)) return;
  if (tile.pixels() == 1)
    throw limit_error(
        "pixel (" + std::to_string(tile.x) + ", " + std::to_string(tile.y) + ")",
        "its rays exceed --memory " + std::to_string(settings_.memory_mib) + "; lower --depth or raise --cutoff");
  Tile first = tile, second = tile;
  if (tile.height > 1) {  // whole rows while there are several: they keep the raster pass simple
    const std::uint32_t rows = std::clamp(memory_.tile_pixels / tile.width, 1U, (tile.height + 1) / 2);
    first.height = tile.pixels() > memory_.tile_pixels ? rows : tile.height / 2;
    second.y += first.height;
    second.height -= first.height;
  } else {
    first.width = tile.width / 2;
    second.x += first.width;
    second.width -= first.width;
  }
  render_tiles(request, first, out);
  render_tiles(request, second, out);
}

bool Renderer::render_tile(const FrameRequest& request, const Tile& tile, RenderedFrame& out) {
  begin_tile(tile);
  if (adaptive_) return render_round(request, tile, out);
  if (layers_) render_layers(request, tile);
  for (std::uint32_t sample = 0; sample < settings_.samples.most; ++sample) {
    if (render_batch(request, {sample, 1, tile.pixels()}, tile, sample + 1 == settings_.samples.most)) continue;
    if (dump_ != nullptr) dump_->rewind();
    return false;
  }
  store_tile(tile, out);
  return true;
}

// The layers are what the rays through the pixels' centres see.
void Renderer::render_layers(const FrameRequest& request, const Tile& tile) {
  if (settings_.samples.most == 1) return;  // then the one sample is that ray
  camera_hits(request, {settings_.samples.most, 1, tile.pixels()}, tile);
  layers_->record(recorder_, memory_, tile.pixels());
  recorder_.fill(memory_.stats, 0);  // not rays of the picture
  if (memory_.pixel_tests) recorder_.fill(memory_.pixel_tests, 0, 0, std::uint64_t{tile.pixels()} * 4);
}

void Renderer::begin_tile(const Tile& tile) {
  recorder_.stage("generate");
  if (!direct())  // else the first sample writes them
    recorder_.fill(memory_.accumulation, 0, 0, std::uint64_t{tile.pixels()} * 32);
  recorder_.fill(memory_.stats, 0);
  records_.clear();
  rays_seen_ = 0;
  if (memory_.pixel_tests) recorder_.fill(memory_.pixel_tests, 0, 0, std::uint64_t{tile.pixels()} * 4);
  if (dump_ != nullptr) dump_->mark();
}

// Recorded behind the last batch, before it is known whether that one's rays fitted: a wait less for each tile.
void Renderer::finish_tile(const Tile& tile) {
  if (adaptive_)
    recorder_.copy(memory_.accumulation, memory_.accumulation_readback, std::uint64_t{tile.pixels()} * 32);
  else
    resolve_.record(recorder_, memory_, tile.pixels(), settings_.samples.most);
  if (memory_.pixel_tests)
    recorder_.copy(memory_.pixel_tests, memory_.pixel_tests_readback, std::uint64_t{tile.pixels()} * 4);
  recorder_.copy(memory_.records, memory_.records_readback, records_.size() * gpu::COUNT_WORDS * 4);
}

void Renderer::camera_hits(const FrameRequest& request, const Batch& batch, const Tile& tile) {
  set_frame(request.camera, batch, tile);
  recorder_.fill(memory_.counters, 0);
  if (raster_) raster_->record(recorder_, *scene_, memory_, tile, settings_.width, settings_.height);
  if (direct()) return;
  generate_.primary(recorder_, memory_, batch.rays);
  if (raster_) return;
  compact_.record_all(recorder_, memory_.reflection[1], gpu::KIND_PRIMARY, batch.rays);
  way_->tracer->trace(recorder_, memory_.reflection[1], gpu::KIND_PRIMARY, 0);
}

// False where its rays did not fit the lists. The last batch of a tile also brings its sums and counts to the host.
bool Renderer::render_batch(const FrameRequest& request, const Batch& batch, const Tile& tile, bool last) {
  if (request.stop && request.stop())
    throw Error(ErrorKind::interrupted, "frame " + std::to_string(request.number) + ": interrupted");
  choose_way(false);
  const Spent before = spent();
  camera_hits(request, batch, tile);
  if (dump_ != nullptr) list_dump_->list(recorder_, *dump_, memory_.reflection[1], gpu::KIND_PRIMARY, 0, batch.rays);
  if (layers_ && settings_.samples.most == 1) layers_->record(recorder_, memory_, tile.pixels());
  const std::uint32_t sums = direct() && batch.first == 0 ? gpu::SUMS_UNSET
                             : one_ray_a_pixel(0)         ? gpu::SUMS_OWN
                                                          : gpu::SUMS_SHARED;
  generate_.secondary(recorder_, memory_, {0, true, direct(), sums});
  trace_shadows(0);
  const auto counters = memory_.counters_readback.view<std::uint32_t>();
  for (std::uint32_t g = 1; g <= plan_.generations; ++g) {
    const std::uint32_t from = (g - 1) % 2;
    if (plan_.reflections) trace(memory_.reflection[from], gpu::KIND_REFLECTION, g);
    if (plan_.refractions) trace(memory_.refraction[from], gpu::KIND_REFRACTION, g);
    // Of either kind, a list each, a ray makes one.
    const std::uint32_t parents = one_ray_a_pixel(g - 1) ? gpu::SUMS_OWN : gpu::SUMS_SHARED;
    generate_.secondary(recorder_, memory_, {from, false, false, parents});
    trace_shadows(g);
    // Past --depth there are but rays that went through blended surfaces: seldom any.
    if ((g % generations_a_submit != 0 && g != settings_.depth) || g == plan_.generations) continue;
    recorder_.copy(memory_.counters, memory_.counters_readback, gpu::COUNT_WORDS * 4);
    recorder_.submit_and_wait();
    if (counters[gpu::COUNT_PARENTS] == 0) break;
  }
  recorder_.copy(memory_.counters, memory_.counters_readback, gpu::COUNT_WORDS * 4);
  recorder_.copy(memory_.stats, memory_.stats_readback, memory_.stats.bytes());
  if (last) finish_tile(tile);
  recorder_.submit_and_wait();
  if (counters[gpu::COUNT_OVERFLOW] != 0) return false;
  note_batch(before, batch);
  return true;
}

void Renderer::trace(const RayList& list, std::uint32_t kind, std::uint32_t generation) {
  compact_.record(recorder_, list, kind);
  way_->tracer->trace(recorder_, list, kind, generation);
  note_record(kind, generation);
  if (dump_ != nullptr) list_dump_->list(recorder_, *dump_, list, kind, generation, 0);
}

void Renderer::set_dump(DumpWriter* dump) {
  dump_ = dump;
  if (dump != nullptr && !list_dump_) list_dump_.emplace(device_, *scene_, memory_);
}

// The device's counters now say how many rays the list had, how it was sorted and bundled.
void Renderer::note_record(std::uint32_t kind, std::uint32_t generation) {
  if (records_.size() == max_records) return;  // deeper ones count in the totals only
  recorder_.copy(memory_.counters, memory_.records, gpu::COUNT_WORDS * 4, 0, records_.size() * gpu::COUNT_WORDS * 4);
  records_.push_back({generation, kind, way_, way_->tracer->pairs_per_level()});
}

void Renderer::trace_shadows(std::uint32_t generation) {
  if (!plan_.shadows) return;
  trace(memory_.shadow, gpu::KIND_SHADOW, generation);
  const bool primary = generation == 0;
  shade_.record(recorder_, memory_,
                {primary, one_ray_a_pixel(primary ? 0 : generation - 1), one_ray_a_pixel(generation)});
}

// Of the generation's rays together.
bool Renderer::one_ray_a_pixel(std::uint32_t generation) const {
  return !plan_.adaptive && (generation == 0 || !plan_.refractions);
}

}  // namespace sheaf
