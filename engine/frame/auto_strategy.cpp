// SPDX-License-Identifier: MIT
#include "frame/auto_strategy.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <sstream>

#include "sampling/adaptive_pixels.hpp"
#include "vulkan/kernel.hpp"

namespace sheaf {
namespace {

// CPU time on a CPU device (Mesa 25.0.7, Zen 5, one core): translating hybrid's kernels took 11 times as long as bvh's
// (1.45 s; 1.2 to 1.6 with other features), and, where the driver's cache had none, one thread compiled them within
// their first dispatches in 2.2 times as long again.
constexpr double bvh_makes_ms = 130, hybrid_over_bvh = 11, compiling_over_making = 2.2;
constexpr double bvh_saves = 0.04;
// A camera ray and what comes of it cost 0.45 to 0.9 µs by bvh, of which traversal is the half.
constexpr double least_camera_ray_ms = 0.4e-3, least_tracing = 0.4;

std::string environment(const char* name) {
  const char* const value = std::getenv(name);
  return value != nullptr ? value : "";
}

std::string folder_of_marks() {
  const std::string disabled = environment("MESA_SHADER_CACHE_DISABLE");
  if (disabled == "true" || disabled == "1") return "";
  const std::string given = environment("MESA_SHADER_CACHE_DIR"), caches = environment("XDG_CACHE_HOME"),
                    home = environment("HOME");
  if (!given.empty()) return given + "/sheaf";
  if (!caches.empty()) return caches + "/sheaf";
  return home.empty() ? "" : home + "/.cache/sheaf";
}

// FNV-1a, 64 bits, a step for each character or word.
class Hash {
 public:
  template <typename Items>
  void add(const Items& items) {
    for (const auto item : items) value_ = (value_ ^ static_cast<std::uint32_t>(item)) * 0x100000001b3U;
  }
  [[nodiscard]] std::string text() const {
    std::ostringstream out;
    out << std::hex << std::setw(16) << std::setfill('0') << value_;
    return out.str();
  }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325U;
};

// Part of traversal's time that hybrid is expected to save: bundles pay where neighbouring rays meet the same
// triangles. Measured, triangles per pixel and saving of all CPU time: 0.003, 13 % (Cornell box); 0.015, 18 %
// (animation); 0.1, 11 % (a city); 0.24, -5 % (a crowd); 0.28, 22 % (Sponza); 0.56, -2 % (spheres); 1.6, -8 %; 4, 6 %
// (Sponza again) and -19 %. Where it is not known, a run of a hundred times the price pays for finding out.
double expected_saving(std::uint64_t triangles, const RenderSettings& settings) {
  const double a_pixel = static_cast<double>(triangles) / (static_cast<double>(settings.width) * settings.height);
  if (a_pixel < 0.05) return 0.35;
  if (a_pixel < 0.3) return 0.25;
  return a_pixel < 1 ? 0.05 : 0.02;
}

double camera_rays_of(const RenderSettings& settings, std::uint64_t frames) {
  // Adaptive: as many as each pixel gets at least.
  const std::uint32_t samples = settings.samples.error ? 2 * AdaptivePixels::first_round : settings.samples.most;
  return static_cast<double>(settings.width) * settings.height * samples * static_cast<double>(frames);
}

}  // namespace

CompiledKernels::CompiledKernels(const Device& device, const Features& features, const RenderSettings& settings,
                                 const Plan& plan)
    : folder_(folder_of_marks()) {
  Hash hash;
  hash.add(device.physical().getProperties().pipelineCacheUUID);
  hash.add(device.summary().name + device.summary().driver);
  for (const char* stem : {"traverse_single", "traverse_bundles", "traverse_packets"}) hash.add(shader_code(stem));
  std::ostringstream constants;
  constants << features.masked << features.translucent() << features.textured << settings.counted
            << settings.layers.tests << plan.transform_on_fetch << plan.shadows << ' ' << device.limits().subgroup
            << ' ' << device.limits().bundle << ' ' << device.limits().workers;
  hash.add(constants.str());
  variant_ = hash.text();
}

std::string CompiledKernels::path(Strategy strategy) const {
  return (std::filesystem::path(folder_) / (std::string("compiled-") + name_of(strategy) + "-" + variant_)).string();
}

bool CompiledKernels::hold(Strategy strategy) const {
  std::error_code ignored;
  return !folder_.empty() && std::filesystem::exists(path(strategy), ignored);
}

void CompiledKernels::note(Strategy strategy) const {
  if (folder_.empty() || hold(strategy)) return;
  std::error_code ignored;
  std::filesystem::create_directories(folder_, ignored);
  std::ofstream(path(strategy)).flush();
}

AutoStrategy::AutoStrategy(const Device& device, const RenderSettings& settings, const CompiledKernels& compiled,
                           const Run& run)
    : cpu_(device.limits().cpu), workers_(cpu_ ? device.limits().workers : 1), trial_(terms_) {
  if (const std::string given = environment("SHEAF_AUTO_PRICE"); !given.empty())
    given_price_ = std::strtod(given.c_str(), nullptr);
  first_compiled_ = compiled.hold(Strategy::bvh);
  second_compiled_ = compiled.hold(Strategy::hybrid);
  terms_.camera_rays = camera_rays_of(settings, run.frames);
  terms_.span = settings.samples.most > 1 ? 2 : std::clamp(run.tiles, 1U, 8U);
  terms_.compiles_first = !first_compiled_ && !given_price_;
  terms_.saving = expected_saving(run.triangles, settings);
  first_made(bvh_makes_ms);
  // A long run begins with hybrid, which bvh may then show to be the dearer.
  const double least_saving_ms = terms_.camera_rays * least_camera_ray_ms * least_tracing * terms_.saving;
  if (cpu_ && !given_price_ && terms_.saving > 0.1 && least_saving_ms > 2 * terms_.price_ms) {
    std::swap(terms_.first, terms_.second);
    std::swap(first_compiled_, second_compiled_);
    terms_.compiles_first = !first_compiled_;
    terms_.saving = bvh_saves;
    first_made(bvh_makes_ms * hybrid_over_bvh);
  }
  trial_ = StrategyTrial(terms_);
}

void AutoStrategy::first_made(double cpu_ms) {
  const double making = terms_.second == Strategy::hybrid ? cpu_ms * hybrid_over_bvh : cpu_ms / hybrid_over_bvh;
  // While one thread compiles, the others of a CPU device wait.
  const double compiling = second_compiled_ ? 0 : making * compiling_over_making * workers_;
  terms_.price_ms = given_price_.value_or(making + compiling);
  trial_.set_price(terms_.price_ms);
}

}  // namespace sheaf
