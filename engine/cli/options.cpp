// SPDX-License-Identifier: MIT
#include "cli/options.hpp"

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <sstream>

#include "core/error.hpp"
#include "core/quote.hpp"

namespace sheaf {
namespace {

Error bad(const std::string& option, const std::string& value, const std::string& reason) {
  return {ErrorKind::usage, "--" + option + " " + quote(value) + ": " + reason};
}

void parse_size(const std::string& text, RenderSettings& settings) {
  const auto cross = text.find('x');
  const char* end = text.data() + text.size();
  if (cross != std::string::npos) {
    const auto w = std::from_chars(text.data(), text.data() + cross, settings.width);
    const auto h = std::from_chars(text.data() + cross + 1, end, settings.height);
    if (w.ec == std::errc() && h.ec == std::errc() && w.ptr == text.data() + cross && h.ptr == end) return;
  }
  throw bad("size", text, "must be WIDTHxHEIGHT, for example 1280x720");
}

glm::vec3 parse_color(const std::string& option, const std::string& text) {
  glm::vec3 color(0);
  std::stringstream parts(text);
  std::string part;
  int count = 0;
  for (; std::getline(parts, part, ','); ++count) {
    char* end = nullptr;
    const float value = std::strtof(part.c_str(), &end);
    if (part.empty() || *end != '\0' || count > 2) throw bad(option, text, "must be R,G,B");
    color[count] = value;
  }
  if (count != 3) throw bad(option, text, "must be R,G,B");
  return color;
}

double parse_number(const std::string& option, const std::string& text, const std::string& part) {
  char* end = nullptr;
  const double value = std::strtod(part.c_str(), &end);
  if (part.empty() || *end != '\0') throw bad(option, text, "must be a number, or a fraction such as 24000/1001");
  return value;
}

float parse_z_background(const std::string& text) {
  char* end = nullptr;
  const float value = std::strtof(text.c_str(), &end);
  if (text.empty() || *end != '\0' || std::isnan(value)) throw bad("z-background", text, "must be a number or inf");
  if (std::isinf(value) && text.find_first_of("iI") == std::string::npos)
    throw Error(ErrorKind::input, "--z-background " + text + ": must be at most 3.4e38, or inf");
  return value;
}

double parse_fps(const std::string& text) {
  const auto slash = text.find('/');
  double fps = parse_number("fps", text, text.substr(0, slash));
  if (slash != std::string::npos) fps /= parse_number("fps", text, text.substr(slash + 1));
  if (!(fps > 0 && fps <= 1e6))
    throw Error(ErrorKind::input, "--fps " + quote(text) + ": must be above 0 and at most 1000000");
  return fps;
}

std::string quality_help() {
  std::ostringstream text;
  text << "named settings, which others given beside it change:";
  for (const auto& q : qualities)
    text << (&q == qualities.data() ? " " : "; ") << q.name << " = --spp " << text_of(q.samples) << " --depth "
         << q.depth << " --cutoff " << q.cutoff;
  return text.str();
}

template <typename T>
T one_of(const std::string& option, const std::string& value, const std::vector<std::pair<std::string, T>>& choices) {
  std::string known;
  for (const auto& [name, result] : choices) {
    if (name == value) return result;
    known += (known.empty() ? "" : ", ") + name;
  }
  throw bad(option, value, "must be one of " + known);
}

}  // namespace

void add_render_options(CLI::App& command, RenderOptions& o) {
  command.add_option("scene", o.scene, "a .glb or .gltf file")->required();
  command.add_option("--out", o.out, "folder for the frames; made if missing")->required();
  command.add_option("--camera", o.camera, "camera path, JSON (our own or Nerfstudio's)");
  command.add_option("--camera-node", o.camera_node, "camera of the scene: name or index");
  command.add_option("--scene-name", o.scene_name, "which glTF scene: name or index; default the file's own");
  command.add_option("--frames", o.frames, "A-B[:STEP] or N,M,...")->capture_default_str();
  command.add_option("--fps", o.fps_text,
                     "frame f shows time f / fps, 24000/1001 for example; default the camera path's, else 24");
  command.add_option("--animation", o.animation, "name, index or all; default the first");
  command.add_option("--size", o.size, "WIDTHxHEIGHT")->capture_default_str();
  command.add_option("--quality", o.quality, quality_help());
  command.add_option("--spp", o.spp, "samples a pixel, or adaptive:ERROR[:MOST]: more where the error is; default 1");
  command.add_option("--filter", o.filter, "how samples make up a pixel: box, triangle or gaussian")
      ->capture_default_str();
  command.add_option("--depth", o.depth, "generations of reflection and refraction; default 4");
  command.add_option("--cutoff", o.cutoff, "least weight of a ray worth following; default 0.002");
  command
      .add_option("--strategy", o.strategy,
                  "auto, hybrid, crsh, rsh, frustum, classify, bvh, brute, rayquery, reference")
      ->capture_default_str();
  command.add_option("--sort", o.sort, "auto, on or off")->capture_default_str();
  command
      .add_option("--primary", o.primary,
                  "raster, trace or auto: raster, but where a pixel has more than eight triangles")
      ->capture_default_str();
  command
      .add_option("--instances", o.instances,
                  "copied: a triangle an instance (fast), shared: posed when read (small), or auto: shared from 8 "
                  "million copied triangles on")
      ->capture_default_str();
  command.add_option("--aov", o.layers, "layers: Z,N,P,albedo,UV,id,tests or all");
  command.add_option("--z-background", o.z_background, "layer Z where nothing is hit: a number or inf")
      ->capture_default_str();
  command.add_option("--compression", o.compression, "none, rle, zips, zip, piz, dwaa")->capture_default_str();
  command.add_option("--name", o.name, "file names; default <scene>.####.exr");
  command.add_option("--environment", o.environment,
                     "R,G,B radiance of what rays that miss see; default 0, or 0.4 in a scene without lights");
  command.add_option("--stats", o.stats, "times and counts, JSON");
  command.add_option("--count", o.count, "auto, on or off: count tests (auto: where --stats or the tests layer ask)")
      ->capture_default_str();
  command.add_option("--dump", o.dump, "folder for every ray and hit, .npy");
  command.add_option("--device", o.device, "index or part of a name");
  command.add_option("--memory", o.settings.memory_mib, "MiB for rays, and what else scales with the picture")
      ->capture_default_str();
  command.add_option("--progress", o.progress, "auto, bar, json or none")->capture_default_str();
  command.add_flag("--resume", o.resume, "leave frames that are already whole alone");
  command
      .add_option("--glass-alpha", o.glass_alpha,
                  "opaque, or transparent: the background shows through transmission, alpha is what glass holds back")
      ->capture_default_str();
  command.add_flag("--opaque", o.settings.opaque, "every surface opaque and two-sided");
  command.add_flag("--preview", o.preview, "a tone-mapped PNG beside each frame");
}

void resolve_options(RenderOptions& o) {
  RenderSettings& s = o.settings;
  parse_size(o.size, s);
  const Quality& quality = parse_quality(o.quality);
  s.samples = o.spp ? parse_samples(*o.spp) : quality.samples;
  s.depth = o.depth.value_or(quality.depth);
  s.cutoff = o.cutoff.value_or(quality.cutoff);
  s.filter = parse_filter(o.filter);
  s.strategy = parse_strategy(o.strategy);
  s.sort = one_of<SortPolicy>("sort", o.sort,
                              {{"auto", SortPolicy::automatic}, {"on", SortPolicy::on}, {"off", SortPolicy::off}});
  s.primary = one_of<PrimaryMethod>(
      "primary", o.primary,
      {{"auto", PrimaryMethod::automatic}, {"raster", PrimaryMethod::raster}, {"trace", PrimaryMethod::trace}});
  s.instances = one_of<InstancePolicy>(
      "instances", o.instances,
      {{"auto", InstancePolicy::automatic}, {"copied", InstancePolicy::copied}, {"shared", InstancePolicy::shared}});
  s.layers = parse_layers(o.layers);
  s.z_background = parse_z_background(o.z_background);
  s.transparent_glass = one_of<bool>("glass-alpha", o.glass_alpha, {{"opaque", false}, {"transparent", true}});
  const int count = one_of<int>("count", o.count, {{"auto", -1}, {"on", 1}, {"off", 0}});
  s.counted = count == 1 || (count == -1 && (!o.stats.empty() || s.layers.tests));
  if (!o.environment.empty()) s.environment = parse_color("environment", o.environment);
  if (!o.fps_text.empty()) o.fps = parse_fps(o.fps_text);
  if (!o.camera.empty() && !o.camera_node.empty())
    throw Error(ErrorKind::usage, "--camera and --camera-node: only one of them can choose the camera");
  std::vector<std::string> layers;
  std::stringstream parts(o.layers);
  for (std::string part; std::getline(parts, part, ',');) layers.push_back(part);
  if (const auto conflict = compression_conflict(parse_compression(o.compression), layers); !conflict.empty())
    throw Error(ErrorKind::usage, conflict);
  check_settings(s);
}

}  // namespace sheaf
