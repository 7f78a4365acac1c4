// SPDX-License-Identifier: MIT
#include "frame/renderer.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>

#include "core/error.hpp"
#include "stages/sort.hpp"

namespace sheaf {
namespace {

constexpr std::uint32_t generations_a_submit = 4;  // between looks at whether any ray is left

double radical_inverse(std::uint32_t i) {
  double result = 0, digit = 0.5;
  for (; i != 0; i >>= 1U, digit *= 0.5)
    if ((i & 1U) != 0) result += digit;
  return result;
}

// Root first; trees of different heights agree at the bottom.
void add_levels(std::vector<std::uint64_t>& sum, const std::vector<std::uint64_t>& more) {
  if (sum.size() < more.size()) sum.insert(sum.begin(), more.size() - sum.size(), 0);
  for (std::size_t below = 1; below <= more.size(); ++below) sum[sum.size() - below] += more[more.size() - below];
}

}  // namespace

Renderer::Renderer(const Device& device, const Scene& scene, const Features& features, const RenderSettings& settings,
                   Strategy strategy)
    : device_(device),
      features_(features),
      settings_(settings),
      plan_(make_plan(features, settings, strategy)),
      recorder_(device),
      scene_(device, recorder_, scene, settings, plan_),
      memory_(make_ray_memory(device, settings, plan_, features, scene_.lights())),
      animate_(device, plan_, !scene_.layout().deforms.empty()),
      objects_(device, plan_),
      generate_(device, plan_, features_, settings.counted),
      compact_(device),
      shade_(device, features_, settings.counted),
      resolve_(device) {
  if (plan_.raster) raster_.emplace(device, features_);
  if (settings.layers.any_surface()) layers_.emplace(device, plan_, features_);
  tracer_ = make_tracer({device_, scene_, memory_, plan_, features_, settings_, strategy, settings.counted});
}

void Renderer::bind_all() {
  scene_.bind(recorder_);
  recorder_.bind(ROLE_FRAME, memory_.frame);
  recorder_.bind(ROLE_COUNTERS, memory_.counters);
  recorder_.bind(ROLE_ARGS, memory_.args);
  recorder_.bind(ROLE_BLOCK_SUMS, memory_.block_sums);
  recorder_.bind(ROLE_ACCUMULATION, memory_.accumulation);
  recorder_.bind(ROLE_STATS, memory_.stats);
  if (memory_.pixel_tests) recorder_.bind(ROLE_PIXEL_TESTS, memory_.pixel_tests);
}

void Renderer::set_frame(const CameraView& camera, std::uint32_t sample, const Tile& tile) {
  gpu::Frame f{};
  const double aspect = static_cast<double>(settings_.width) / settings_.height;
  const double half_y = camera.orthographic ? camera.half_height : camera.tan_half_y;
  f.eye = glm::vec3(glm::dvec3(camera.to_world[3]) - scene_.origin());
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
  const double n = settings_.samples;
  f.jitter_x = n == 1 ? 0.5F : static_cast<float>(radical_inverse(sample) + 0.5 / n);
  f.jitter_y = n == 1 ? 0.5F : static_cast<float>((sample + 0.5) / n);
  f.lights = scene_.lights();
  f.triangles = scene_.triangles();
  f.capacity = memory_.capacity;
  f.instances = static_cast<std::uint32_t>(scene_.layout().instances.size());
  f.sample_index = sample;
  f.box_pad = scene_.box_pad();
  f.tile_x = tile.x;
  f.tile_y = tile.y;
  f.tile_width = tile.width;
  f.tile_height = tile.height;
  scene_.set_addresses(f);
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

  const Motion motion = scene_.update(request.pose, request.camera, recorder_);
  bind_all();
  const Tile whole = request.only.value_or(Tile{0, 0, settings_.width, settings_.height});
  set_frame(request.camera, 0, whole);
  animate_.record(recorder_, scene_, motion);
  objects_.record(recorder_, scene_, motion);
  tracer_->objects_moved(recorder_, motion);
  if (dump_ != nullptr) {
    dump_->begin(request.number);
    list_dump_->triangles(recorder_, *dump_);
  }
  render_tiles(request, whole, out);
  if (dump_ != nullptr) dump_->end();

  const auto times = recorder_.take_times();
  for (const char* name : stage_names)
    if (const auto found = times.find(name); found != times.end())
      out.stats.stages_ms.emplace_back(name, found->second);
  out.stats.peak_device_mib = static_cast<double>(device_.peak_bytes()) / (1 << 20);
  std::uint64_t rays = 0;
  for (const auto count : out.stats.rays) rays += count;
  out.stats.brute_force = rays * scene_.triangles();
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
  recorder_.stage("generate");
  recorder_.fill(memory_.accumulation, 0, 0, std::uint64_t{tile.pixels()} * 32);
  recorder_.fill(memory_.stats, 0);
  records_.clear();
  record_pairs_.clear();
  if (memory_.pixel_tests) recorder_.fill(memory_.pixel_tests, 0, 0, std::uint64_t{tile.pixels()} * 4);
  if (dump_ != nullptr) dump_->mark();
  for (std::uint32_t sample = 0; sample < settings_.samples; ++sample) {
    if (render_sample(request, sample, tile)) continue;
    if (dump_ != nullptr) dump_->rewind();
    return false;
  }
  resolve_.record(recorder_, memory_, tile.pixels(), settings_.samples);
  recorder_.copy(memory_.stats, memory_.stats_readback, memory_.stats.bytes());
  if (memory_.pixel_tests)
    recorder_.copy(memory_.pixel_tests, memory_.pixel_tests_readback, std::uint64_t{tile.pixels()} * 4);
  recorder_.copy(memory_.records, memory_.records_readback, records_.size() * gpu::COUNT_WORDS * 4);
  recorder_.submit_and_wait();
  store_tile(tile, out);
  return true;
}

bool Renderer::render_sample(const FrameRequest& request, std::uint32_t sample, const Tile& tile) {
  set_frame(request.camera, sample, tile);
  recorder_.fill(memory_.counters, 0);
  if (raster_) raster_->record(recorder_, scene_, memory_, tile, settings_.width, settings_.height);
  generate_.primary(recorder_, memory_, tile.pixels());
  if (!raster_) {
    compact_.record_all(recorder_, memory_.reflection[1], gpu::KIND_PRIMARY, tile.pixels());
    tracer_->trace(recorder_, memory_.reflection[1], gpu::KIND_PRIMARY, 0);
  }
  if (dump_ != nullptr) list_dump_->list(recorder_, *dump_, memory_.reflection[1], gpu::KIND_PRIMARY, 0, tile.pixels());
  if (layers_ && sample == 0) layers_->record(recorder_, memory_, tile.pixels());
  generate_.secondary(recorder_, memory_, 0, true, settings_.depth == 0);
  trace_shadows(0);
  const auto counters = memory_.counters_readback.view<std::uint32_t>();
  for (std::uint32_t g = 1; g <= settings_.depth; ++g) {
    if (!plan_.reflections && !plan_.refractions) break;
    const std::uint32_t from = (g - 1) % 2;
    if (plan_.reflections) trace(memory_.reflection[from], gpu::KIND_REFLECTION, g);
    if (plan_.refractions) trace(memory_.refraction[from], gpu::KIND_REFRACTION, g);
    generate_.secondary(recorder_, memory_, from, false, g == settings_.depth);
    trace_shadows(g);
    if (g % generations_a_submit != 0 || g == settings_.depth) continue;
    recorder_.copy(memory_.counters, memory_.counters_readback, gpu::COUNT_WORDS * 4);
    recorder_.submit_and_wait();
    if (counters[gpu::COUNT_PARENTS] == 0) break;
  }
  recorder_.copy(memory_.counters, memory_.counters_readback, gpu::COUNT_WORDS * 4);
  recorder_.submit_and_wait();
  return counters[gpu::COUNT_OVERFLOW] == 0;
}

void Renderer::trace(const RayList& list, std::uint32_t kind, std::uint32_t generation) {
  compact_.record(recorder_, list, kind);
  tracer_->trace(recorder_, list, kind, generation);
  note_record(kind, generation);
  if (dump_ != nullptr) list_dump_->list(recorder_, *dump_, list, kind, generation, 0);
}

void Renderer::set_dump(DumpWriter* dump) {
  dump_ = dump;
  if (dump != nullptr && !list_dump_) list_dump_.emplace(device_, scene_, memory_);
}

// The device's counters now say how many rays the list had, how it was sorted and bundled.
void Renderer::note_record(std::uint32_t kind, std::uint32_t generation) {
  if (records_.size() == max_records) return;  // deeper ones count in the totals only
  recorder_.copy(memory_.counters, memory_.records, gpu::COUNT_WORDS * 4, 0, records_.size() * gpu::COUNT_WORDS * 4);
  records_.emplace_back(generation, kind);
  record_pairs_.push_back(tracer_->pairs_per_level());
}

void Renderer::collect_generations(RenderedFrame& out) {
  const auto words = memory_.records_readback.view<std::uint32_t>();
  for (std::size_t r = 0; r < records_.size(); ++r) {
    const auto* counters = &words[r * gpu::COUNT_WORDS];
    const auto [generation, kind] = records_[r];
    if (counters[gpu::COUNT_RAYS + kind] == 0) continue;
    auto found =
        std::find_if(out.stats.generations.begin(), out.stats.generations.end(), [&](const GenerationStats& g) {
          return g.index == records_[r].first && g.kind == static_cast<RayKind>(records_[r].second);
        });
    if (found == out.stats.generations.end()) {
      out.stats.generations.push_back({});
      found = std::prev(out.stats.generations.end());
      found->index = generation;
      found->kind = static_cast<RayKind>(kind);
      found->sort_reason = plan_.sorts ? "key changes in less than one ray of sixteen" : "strategy or --sort off";
    }
    found->rays += counters[gpu::COUNT_RAYS + kind];
    add_levels(found->pairs_per_level, record_pairs_[r]);
    if (!plan_.sorts || kind == gpu::KIND_PRIMARY) continue;
    const KeyLayout layout = key_layout(kind, scene_.lights(), memory_.tile_pixels);
    found->key_bits = layout.bits();
    found->chunks += counters[gpu::COUNT_CHUNKS];
    found->nodes += counters[gpu::COUNT_TIGHT] + counters[gpu::COUNT_LOOSE];
    found->tight += counters[gpu::COUNT_TIGHT];
    if (counters[gpu::COUNT_SORT] != 0) {
      found->sorted = true;
      found->sort_reason =
          settings_.sort == SortPolicy::on ? "--sort on" : "key changes in more than one ray of sixteen";
    }
  }
}

void Renderer::trace_shadows(std::uint32_t generation) {
  if (!plan_.shadows) return;
  trace(memory_.shadow, gpu::KIND_SHADOW, generation);
  shade_.record(recorder_, memory_);
}

void Renderer::store_tile(const Tile& tile, RenderedFrame& out) {
  const auto pixels = memory_.readback.view<float>();
  for (std::uint32_t y = 0; y < tile.height; ++y)
    std::copy_n(pixels.begin() + static_cast<std::ptrdiff_t>(y) * tile.width * 4, std::size_t{tile.width} * 4,
                out.layers.rgba.begin() + (static_cast<std::ptrdiff_t>(tile.y + y) * settings_.width + tile.x) * 4);
  if (layers_) Layers::store(memory_, tile, scene_.origin(), out.layers);
  if (!out.layers.tests.empty()) {
    const auto tests = memory_.pixel_tests_readback.view<std::uint32_t>();
    for (std::uint32_t i = 0; i < tile.pixels(); ++i)
      out.layers.tests[std::size_t{tile.y + i / tile.width} * settings_.width + tile.x + i % tile.width] =
          static_cast<float>(tests[i]);
  }
  collect_stats(out);
  collect_generations(out);
}

void Renderer::collect_stats(RenderedFrame& out) {
  const auto stats = memory_.stats_readback.view<std::uint64_t>();
  for (std::uint32_t kind = 0; kind < ray_kinds; ++kind) {
    const auto* of = &stats[kind * gpu::STAT_FIELDS];
    out.stats.rays[kind] += of[gpu::STAT_RAYS];
    out.stats.hits[kind] += of[gpu::STAT_HITS];
    out.stats.node_object[kind] += of[gpu::STAT_NODE_OBJECT];
    out.stats.ray_box[kind] += of[gpu::STAT_RAY_BOX];
    out.stats.ray_triangle[kind] += of[gpu::STAT_RAY_TRIANGLE];
    auto& levels = out.stats.node_object_by_level[kind];  // root last: level 0 are the rays
    for (std::uint32_t l = 0; l < gpu::MAX_LEVELS; ++l) {
      if (of[gpu::STAT_LEVELS + l] == 0) continue;
      if (levels.size() <= l) levels.resize(l + 1);
      levels[l] += of[gpu::STAT_LEVELS + l];
    }
  }
}

}  // namespace sheaf
