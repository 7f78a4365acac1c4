// SPDX-License-Identifier: MIT
// sheaf_bench_embree: a dump's rays through Embree, timed whenever a line is read. Answers are JSON lines: first what
// the check found and each way to follow what moves cost (a warm-up), then one line a round. Ends with its input.
#include <cstdio>
#include <fstream>
#include <iostream>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "agreement.hpp"
#include "dump.hpp"

namespace bench {
namespace {

using nlohmann::json;

constexpr const char* usage =
    "usage: sheaf_bench_embree DUMP_FOLDER [PASSES]\n"
    "  DUMP_FOLDER  one frame, or two between which the scene moves\n"
    "  PASSES       a byte a triangle, not 0 where a shadow ray goes on\n";

struct LoadedBatch {
  oracle::Batch about;
  oracle::NpyArray rays, hits;
  Batch batch;
};

struct LoadedFrame {
  oracle::NpyArray file;
  std::span<const oracle::Triangle> triangles;
  std::vector<LoadedBatch> batches;
};

LoadedFrame load(const oracle::Frame& frame) {
  LoadedFrame loaded{oracle::open_triangles(frame.triangles), {}, {}};
  loaded.triangles = loaded.file.rows<oracle::Triangle>();
  for (const auto& about : frame.batches) {
    LoadedBatch b{about, oracle::open_rays(about.rays), oracle::open_hits(about.hits), {}};
    b.batch = {b.rays.rows<oracle::Ray>(), about.kind == "shadow", {}};
    if (b.batch.rays.size() != b.hits.rows<oracle::Hit>().size()) throw oracle::BadDump("not as many rays as hits");
    loaded.batches.push_back(std::move(b));
  }
  return loaded;
}

std::vector<std::uint8_t> read_bytes(const char* path, std::size_t count) {
  std::ifstream file(path, std::ios::binary);
  std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(file), {}};
  if (bytes.size() != count) throw oracle::BadDump(std::string(path) + ": not a byte for each triangle");
  return bytes;
}

class Contender {
 public:
  Contender(const std::filesystem::path& folder, const char* passes);
  /// Both frames' updates and rays, every method; milliseconds.
  json round(Update update);
  json check();
  [[nodiscard]] const std::vector<Update>& updates() const { return updates_; }
  void keep(Update update) {
    std::erase_if(scenes_, [&](const auto& s) { return s.first != update; });
  }

 private:
  EmbreeScene& scene_of(Update update);
  std::vector<LoadedFrame> frames_;
  std::vector<std::uint8_t> part_of_;
  std::vector<Update> updates_;
  std::vector<std::pair<Update, std::unique_ptr<EmbreeScene>>> scenes_;
  RTCDevice device_ = rtcNewDevice(nullptr);
  unsigned threads_ = std::max(1U, std::thread::hardware_concurrency());
};

Contender::Contender(const std::filesystem::path& folder, const char* passes) {
  for (const auto& frame : oracle::frames_in(folder)) frames_.push_back(load(frame));
  const auto first = frames_.front().triangles, last = frames_.back().triangles;
  if (first.size() != last.size()) throw oracle::BadDump("frames differ in triangles");
  part_of_ = classify(first, last, passes == nullptr ? std::vector<std::uint8_t>{} : read_bytes(passes, first.size()));
  bool moves = false;
  for (const auto part : part_of_) moves |= (part & part_moves) != 0;
  updates_ = moves ? std::vector{Update::refit, Update::low, Update::rebuild} : std::vector{Update::none};
}

EmbreeScene& Contender::scene_of(Update update) {
  for (auto& [which, scene] : scenes_)
    if (which == update) return *scene;
  scenes_.emplace_back(update, std::make_unique<EmbreeScene>(device_, update, frames_[0].triangles, part_of_));
  return *scenes_.back().second;
}

json Contender::round(Update update) {
  EmbreeScene& scene = scene_of(update);
  json frames = json::array();
  for (auto& frame : frames_) {
    scene.place(frame.triangles);
    const Took updated = scene.update();
    json batches = json::array();
    for (auto& b : frame.batches) {
      json ms = json::object(), cpu_ms = json::object();
      for (const Method method : methods) {
        const Took took = trace(scene, b.batch, method, threads_);
        ms[name_of(method)] = took.ms;
        cpu_ms[name_of(method)] = took.cpu_ms;
      }
      batches.push_back({{"generation", b.about.generation}, {"kind", b.about.kind}, {"ms", ms}, {"cpu_ms", cpu_ms}});
    }
    frames.push_back({{"update_ms", updated.ms}, {"cpu_update_ms", updated.cpu_ms}, {"batches", batches}});
  }
  return {{"update", name_of(update)}, {"frames", frames}};
}

json Contender::check() {
  Agreement sum;
  for (const Update update : updates_) {
    EmbreeScene& scene = scene_of(update);
    for (auto& frame : frames_) {
      scene.place(frame.triangles);
      scene.update();
      for (auto& b : frame.batches) {
        for (const Method method : methods) {
          trace(scene, b.batch, method, threads_);
          sum.add(compare(scene, b.batch, frame.triangles, b.hits.rows<oracle::Hit>()));
        }
      }
    }
  }
  std::uint64_t moving = 0, passing = 0;
  for (const auto part : part_of_) {
    moving += (part & part_moves) != 0 ? 1 : 0;
    passing += (part & part_passes) != 0 ? 1 : 0;
  }
  return {{"version", RTC_VERSION_STRING},
          {"threads", threads_},
          {"triangles", part_of_.size()},
          {"moving", moving},
          {"passing", passing},
          {"compared", sum.rays},
          {"same", sum.same},
          {"free", sum.free},
          {"different", sum.different}};
}

// Of a round: the updates and each batch's best method, by CPU time, since one round decides.
double best_cpu_ms(const json& round) {
  double sum = 0;
  for (const auto& frame : round["frames"]) {
    sum += frame["cpu_update_ms"].get<double>();
    for (const auto& batch : frame["batches"]) {
      double least = batch["cpu_ms"].front().get<double>();
      for (const double ms : batch["cpu_ms"]) least = std::min(least, ms);
      sum += least;
    }
  }
  return sum;
}

void say(const json& line) { std::cout << line.dump() << std::endl; }

int run(const char* folder, const char* passes) {
  Contender contender(folder, passes);
  json first = contender.check();
  Update best = contender.updates().front();
  double least = 0;
  for (const Update update : contender.updates()) {
    const json warm = contender.round(update);
    first["warm_up"].push_back(warm);
    const double ms = best_cpu_ms(warm);
    if (least != 0 && ms >= least) continue;
    least = ms;
    best = update;
  }
  contender.keep(best);
  say(first);
  for (std::string line; std::getline(std::cin, line);) say(contender.round(best));
  return 0;
}

}  // namespace
}  // namespace bench

int main(int argc, char** argv) {
  if (argc < 2 || argc > 3 || argv[1][0] == '-') {
    std::fputs(bench::usage, stderr);
    return 2;
  }
  try {
    return bench::run(argv[1], argc > 2 ? argv[2] : nullptr);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "sheaf_bench_embree: %s\n", e.what());
    return 1;
  }
}
