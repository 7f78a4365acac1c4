// SPDX-License-Identifier: MIT
#include "output/stats.hpp"

#include <limits>
#include <sstream>

#include "output_support.hpp"

namespace sheaf {
namespace {

using nlohmann::json;

// Two frames of a scene of 100 triangles; the numbers are small enough to sum up by hand.
RunStats sample() {
  RunStats run{.version = "0.1.0",
               .device_name = "llvmpipe",
               .driver = "Mesa 25.0",
               .strategy = "hybrid",
               .chosen_because = "reflections",
               .scene = {},
               .left_out = {},
               .frames = {},
               .settings = {{"spp", 4}}};
  run.scene = {100, 2, 3, 1, 4, {"reflection"}, {"KHR_y"}, {"KHR_x"}, {"no tangents"}};
  run.left_out = {{"refraction", "no transmissive material"}};
  FrameStats counted{.frame = 12,
                     .time_s = 0.5,
                     .wall_ms = 250,
                     .peak_device_mib = 64.5,
                     .dispatches = 40,
                     .stages_ms = {{"raster", 1.5}, {"generate", 0.25}},
                     .rays = {10, 20, 0, 0},
                     .hits = {8, 5, 0, 0},
                     .node_object = {0, 40, 0, 0},
                     .ray_box = {0, 30, 0, 0},
                     .ray_triangle = {0, 20, 0, 0},
                     .node_object_by_level = {},
                     .brute_force = 3000,
                     .counted = true,
                     .repeated = false,
                     .generations = {},
                     .strategies = {}};
  counted.node_object_by_level[1] = {10, 30};
  counted.generations.push_back({.index = 1,
                                 .kind = RayKind::shadow,
                                 .rays = 20,
                                 .chunks = 5,
                                 .nodes = 3,
                                 .tight = 2,
                                 .sorted = true,
                                 .key_bits = 17,
                                 .sort_reason = "keys pay",
                                 .pairs_per_level = {10, 30}});
  FrameStats timed = counted;
  timed.frame = 13;
  timed.counted = false;
  timed.stages_ms = {{"raster", 2.5}, {"denoise", 0.5}};
  timed.peak_device_mib = 32;
  run.frames = {counted, timed};
  return run;
}

TEST(StatsJson, FrameHasTheSchemasNames) {
  const json expected = json::parse(R"({
    "frame": 12, "time_s": 0.5, "wall_ms": 250.0, "peak_device_mib": 64.5, "dispatches": 40, "blended_stopped": 0, "counted": true, "repeated": false,
    "stages": {"raster": 1.5, "generate": 0.25},
    "rays": {"primary": 10, "shadow": 20, "reflection": 0, "refraction": 0},
    "hits": {"primary": 8, "shadow": 5, "reflection": 0, "refraction": 0},
    "tests": {"brute_force": 3000,
              "node_object": {"primary": 0, "shadow": 40},
              "node_object_by_level": {"primary": [], "shadow": [10, 30]},
              "ray_box": {"primary": 0, "shadow": 30},
              "ray_triangle": {"primary": 0, "shadow": 20}},
    "generations": [{"generation": 1, "kind": "shadow", "rays": 20, "chunks": 5, "nodes": 3, "tight": 2, "sorted": true,
                     "key_bits": 17, "sort_reason": "keys pay", "pairs_per_level": [10, 30]}],
    "strategies": []})");
  EXPECT_EQ(json(to_json(sample())["frames"][0]), expected);
}

TEST(StatsJson, RunHasTheSchemasNames) {
  json run = to_json(sample());
  EXPECT_EQ(run["frames"].size(), 2u);
  run.erase("frames");
  run.erase("totals");
  EXPECT_EQ(run, json::parse(R"({
    "schema": 1, "version": "0.1.0", "device": {"name": "llvmpipe", "driver": "Mesa 25.0"}, "strategy": "hybrid",
    "chosen_because": "reflections", "settings": {"spp": 4},
    "scene": {"triangles": 100, "instances": 2, "meshes": 3, "lights": 1, "materials": 4, "features": ["reflection"],
              "extensions_read": ["KHR_y"], "extensions_ignored": ["KHR_x"], "warnings": ["no tangents"]},
    "left_out": [{"stage": "refraction", "reason": "no transmissive material"}]})"));
}

TEST(StatsJson, TotalsByHand) {
  // Times and rays of both frames; tests of the counted one: 90 tests by 30 rays, of which 20 are shadow rays.
  const json expected = json::parse(R"({
    "frames": 2, "counted_frames": 1, "repeated_frames": 0, "wall_ms": 500.0, "peak_device_mib": 64.5,
    "stages": {"raster": 4.0, "generate": 0.25, "denoise": 0.5},
    "rays": {"primary": 20, "shadow": 40, "reflection": 0, "refraction": 0},
    "hits": {"primary": 16, "shadow": 10, "reflection": 0, "refraction": 0},
    "tests": {"brute_force": 6000, "node_object": {"primary": 0, "shadow": 40}, "ray_box": {"primary": 0, "shadow": 30},
              "ray_triangle": {"primary": 0, "shadow": 20}},
    "rays_per_second": 120.0, "tests_per_ray": 3.0, "tests_per_ray_by_kind": {"primary": 0.0, "shadow": 4.5},
    "reduction_vs_brute_force": 0.97, "reduction_vs_brute_force_by_kind": {"primary": 1.0, "shadow": 0.955}})");
  EXPECT_EQ(json(to_json(sample())["totals"]), expected);
}

TEST(StatsJson, UncountedFramesHaveNoTests) {
  const json tests = to_json(sample())["frames"][1]["tests"];
  EXPECT_EQ(tests, json::parse(R"({"brute_force": 3000, "node_object": {}, "node_object_by_level": {}, "ray_box": {},
                                   "ray_triangle": {}})"));
}

TEST(StatsJson, RatesLeaveRepeatedFramesOut) {
  RunStats run = sample();
  run.frames[1].repeated = true;
  run.frames[1].wall_ms = 1;
  const json totals = to_json(run)["totals"];
  EXPECT_EQ(totals["rays_per_second"], 120.0);
  EXPECT_EQ(totals["repeated_frames"], 1);
  EXPECT_EQ(totals["wall_ms"], 251.0);
}

TEST(StatsJson, NothingToDivideByIsNull) {
  const json totals = to_json(RunStats{})["totals"];
  for (const char* name : {"rays_per_second", "tests_per_ray", "reduction_vs_brute_force"})
    EXPECT_TRUE(totals[name].is_null()) << name;
  EXPECT_EQ(to_json(RunStats{})["frames"], json::array());
}

TEST(StatsJson, CountsAreExactAndTotalsStopAtTheLargest) {
  constexpr std::uint64_t odd = (1ull << 63) + 1;  // a double cannot hold it
  RunStats run = sample();
  run.frames[0].brute_force = run.frames[1].brute_force = odd;
  const std::string text = to_json(run).dump();
  EXPECT_NE(text.find("\"brute_force\":9223372036854775809,"), std::string::npos);
  EXPECT_NE(text.find("\"brute_force\":18446744073709551615,"), std::string::npos);
}

TEST(StatsJson, KeepsTheSchemasOrder) {
  const std::string text = to_json(sample()).dump();
  std::size_t last = 0;
  for (const char* name : {"\"schema\"", "\"version\"", "\"device\"", "\"strategy\"", "\"left_out\"", "\"frames\"",
                           "\"raster\"", "\"generate\"", "\"totals\""}) {
    const std::size_t at = text.find(name, last);
    EXPECT_NE(at, std::string::npos) << name;
    last = at;
  }
}

TEST(StatsCsv, OneLineAFrame) {
  EXPECT_EQ(to_csv(sample()),
            "frame,time_s,wall_ms,peak_device_mib,counted,repeated,animate_ms,objects_ms,raster_ms,generate_ms,hash_ms,"
            "compress_ms,sort_ms,decompress_ms,rays_hierarchy_ms,traverse_ms,compact_ms,intersect_ms,shade_ms,"
            "resolve_ms,write_ms,other_ms,rays_primary,rays_shadow,rays_reflection,rays_refraction,hits_primary,"
            "hits_shadow,hits_reflection,hits_refraction,brute_force,node_object_primary,node_object_shadow,"
            "node_object_reflection,node_object_refraction,ray_box_primary,ray_box_shadow,ray_box_reflection,"
            "ray_box_refraction,ray_triangle_primary,ray_triangle_shadow,ray_triangle_reflection,"
            "ray_triangle_refraction\n"
            "12,0.5,250,64.5,1,0,,,1.5,0.25,,,,,,,,,,,,0,10,20,0,0,8,5,0,0,3000,0,40,0,0,0,30,0,0,0,20,0,0\n"
            "13,0.5,250,32,0,0,,,2.5,,,,,,,,,,,,,0.5,10,20,0,0,8,5,0,0,3000,,,,,,,,,,,,\n");
}

TEST(StatsCsv, HeaderNeverDependsOnTheRun) {
  const std::string with = to_csv(sample()), without = to_csv({});
  EXPECT_EQ(without, with.substr(0, with.find('\n') + 1));
}

TEST(RayKinds, HaveNames) {
  EXPECT_STREQ(name_of(RayKind::primary), "primary");
  EXPECT_STREQ(name_of(RayKind::shadow), "shadow");
  EXPECT_STREQ(name_of(RayKind::reflection), "reflection");
  EXPECT_STREQ(name_of(RayKind::refraction), "refraction");
}

class StatsFileTest : public test::OutputTest {};

TEST_F(StatsFileTest, SurvivesStrangeNamesAndNumbers) {
  RunStats run = sample();
  run.device_name = "caf\xe9";
  run.frames[0].wall_ms = std::numeric_limits<double>::quiet_NaN();
  write_stats(path("s.json"), run);
  const json read = json::parse(test::contents(path("s.json")));
  EXPECT_EQ(read["device"]["name"], "caf\uFFFD");
  EXPECT_TRUE(read["frames"][0]["wall_ms"].is_null());
}

}  // namespace
}  // namespace sheaf
