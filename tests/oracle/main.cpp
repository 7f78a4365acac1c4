// SPDX-License-Identifier: MIT
// sheaf_oracle: checks dumps; a JSON object on stdout. Exit 0: all right, 1: the engine was wrong, 2: bad usage or
// dump.
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>

#include "checker.hpp"
#include "dump.hpp"

namespace oracle {
namespace {

using nlohmann::json;

constexpr const char* usage =
    "usage: sheaf_oracle [--pairs N] [--list N] DUMP_FOLDER...\n"
    "  --pairs N   ray-triangle pairs of brute force a batch, for samples (default 20000000)\n"
    "  --list N    disagreements listed a batch and verdict (default 20)\n";

json as_json(const Hit& hit) {
  return hit.triangle < 0 ? json(nullptr) : json{{"triangle", hit.triangle}, {"t", hit.t}};
}

json as_json(const Tally& tally) {
  json verdicts = json::object(), listed = json::array();
  for (std::size_t v = 0; v < verdict_count; ++v) verdicts[name_of(static_cast<Verdict>(v))] = tally.verdicts[v];
  for (const auto& d : tally.listed)
    listed.push_back({{"ray", d.ray},
                      {"verdict", name_of(d.verdict)},
                      {"engine", as_json(d.engine)},
                      {"embree", as_json(d.embree)}});
  return {{"rays", tally.rays},     {"hits", tally.hits},       {"sampled", tally.sampled},
          {"verdicts", verdicts},   {"worst_t", tally.worst_t}, {"failures", tally.failures()},
          {"disagreements", listed}};
}

json check_batch(const Checker& checker, const Batch& batch) {
  const NpyArray rays = open_rays(batch.rays), hits = open_hits(batch.hits);
  if (rays.rows<Ray>().size() != hits.rows<Hit>().size())
    throw BadDump(batch.rays.string() + ": not as many rays as hits");
  json result = as_json(checker.check(rays.rows<Ray>(), hits.rows<Hit>(), batch.kind == "shadow"));
  result["generation"] = batch.generation;
  result["kind"] = batch.kind;
  return result;
}

json check_folder(const std::filesystem::path& folder, const Effort& effort, std::uint64_t& failures) {
  json frames = json::array();
  for (const Frame& frame : frames_in(folder)) {
    const NpyArray triangles = open_triangles(frame.triangles);
    const Checker checker(triangles.rows<Triangle>(), effort);
    json batches = json::array();
    for (const Batch& batch : frame.batches) {
      batches.push_back(check_batch(checker, batch));
      failures += batches.back()["failures"].get<std::uint64_t>();
    }
    frames.push_back({{"frame", frame.name}, {"triangles", triangles.rows<Triangle>().size()}, {"batches", batches}});
  }
  return {{"folder", folder.string()}, {"frames", frames}};
}

int run(const std::vector<std::string>& arguments) {
  Effort effort;
  std::vector<std::string> folders;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const bool has_value = i + 1 < arguments.size();
    if (arguments[i] == "--pairs" && has_value)
      effort.pairs = std::stoull(arguments[++i]);
    else if (arguments[i] == "--list" && has_value)
      effort.listed = std::stoull(arguments[++i]);
    else if (!arguments[i].starts_with("--"))
      folders.push_back(arguments[i]);
    else
      throw std::invalid_argument(arguments[i]);
  }
  if (folders.empty()) throw std::invalid_argument("no folder");
  std::uint64_t failures = 0;
  json dumps = json::array();
  for (const auto& folder : folders) dumps.push_back(check_folder(folder, effort, failures));
  const json result = {{"embree", EmbreeTracer::version()}, {"failures", failures}, {"dumps", dumps}};
  std::printf("%s\n", result.dump(1).c_str());
  return failures == 0 ? 0 : 1;
}

}  // namespace
}  // namespace oracle

int main(int argc, char** argv) {
  try {
    return oracle::run({argv + 1, argv + argc});
  } catch (const std::invalid_argument& error) {
    std::fprintf(stderr, "sheaf_oracle: %s\n%s", error.what(), oracle::usage);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "sheaf_oracle: %s\n", error.what());
  }
  return 2;
}
