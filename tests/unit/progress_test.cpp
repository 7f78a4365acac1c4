// SPDX-License-Identifier: MIT
#include "output/progress.hpp"

#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "output_support.hpp"

namespace sheaf {
namespace {

using nlohmann::json;

class ProgressTest : public test::OutputTest {
 protected:
  ~ProgressTest() override {
    std::fclose(json_);
    std::fclose(text_);
  }
  [[nodiscard]] std::vector<json> events() const {
    std::istringstream lines(test::contents(path("json")));
    std::vector<json> found;
    for (std::string line; std::getline(lines, line);) found.push_back(json::parse(line));
    return found;
  }
  [[nodiscard]] std::string text() const { return test::contents(path("text")); }

  std::FILE* json_ = std::fopen(path("json").c_str(), "w");
  std::FILE* text_ = std::fopen(path("text").c_str(), "w");
};

TEST_F(ProgressTest, JsonIsOneFlushedObjectALine) {
  Progress progress(ProgressMode::json, json_, text_);
  progress.start(3);
  EXPECT_EQ(events(), (std::vector<json>{{{"event", "start"}, {"frames", 3}, {"version", SHEAF_VERSION}}}));
  progress.frame_done(-12, "out/a.-012.exr", 500);
  progress.warning("line\nbreak and \xff byte");
  progress.error(3, "scene.glb: nodes[2]: bad");
  progress.finish();
  const std::vector<json> all = events();
  ASSERT_EQ(all.size(), 5u);
  EXPECT_EQ(all[1], (json{{"event", "frame"},
                          {"frame", -12},
                          {"done", 1},
                          {"total", 3},
                          {"wall_ms", 500.0},
                          {"eta_s", 1.0},
                          {"file", "out/a.-012.exr"}}));
  EXPECT_EQ(all[2], (json{{"event", "warning"}, {"message", "line\nbreak and \uFFFD byte"}}));
  EXPECT_EQ(all[3], (json{{"event", "error"}, {"code", 3}, {"message", "scene.glb: nodes[2]: bad"}}));
  EXPECT_EQ(all[4]["event"], "done");
  EXPECT_EQ(all[4]["frames"], 1);
  EXPECT_GE(all[4]["wall_s"].get<double>(), 0);
  EXPECT_EQ(text(), "sheaf: scene.glb: nodes[2]: bad\n");
}

TEST_F(ProgressTest, BarShowsPercentFramesAndTimeLeft) {
  Progress progress(ProgressMode::bar, json_, text_);
  progress.start(4);
  progress.frame_done(1, "a", 61000);
  EXPECT_TRUE(text().ends_with("\r\x1b[K[=======>                    ]  25%  1/4 frames  03:03 left")) << text();
  for (int frame = 2; frame <= 4; ++frame) progress.frame_done(frame, "a", 61000);
  progress.finish();
  EXPECT_TRUE(text().ends_with("\r\x1b[K[============================] 100%  4/4 frames\n")) << text();
  EXPECT_TRUE(events().empty());
}

TEST_F(ProgressTest, WarningsStandAboveTheBar) {
  Progress progress(ProgressMode::bar, json_, text_);
  progress.start(2);
  const std::string bar = text();
  progress.warning("careful");
  EXPECT_EQ(text(), bar + "\r\x1b[Ksheaf: warning: careful\n" + bar);
}

TEST_F(ProgressTest, NoneAndAutoWithoutATerminalShowOnlyMessages) {
  for (const ProgressMode mode : {ProgressMode::none, ProgressMode::automatic}) {
    Progress progress(mode, json_, text_);
    progress.start(1);
    progress.frame_done(1, "a", 1);
    progress.finish();
  }
  EXPECT_EQ(text(), "");
  Progress(ProgressMode::none, json_, text_).error(6, "a.exr: disk full");
  EXPECT_EQ(text(), "sheaf: a.exr: disk full\n");
  EXPECT_TRUE(events().empty());
}

TEST_F(ProgressTest, TimeLeftIsTheMedianOfTheLastFrames) {
  Progress progress(ProgressMode::none, json_, text_);
  EXPECT_EQ(progress.seconds_left(), 0);
  progress.start(130);
  EXPECT_EQ(progress.seconds_left(), 0);
  for (int i = 0; i < 30; ++i) progress.frame_done(i, "", 9000);  // slow beginnings leave the window
  for (int i = 30; i < 45; ++i) progress.frame_done(i, "", i == 44 ? 100000 : 2000);
  EXPECT_DOUBLE_EQ(progress.seconds_left(), 2.0 * 85);
  progress.start(0);
  EXPECT_EQ(progress.seconds_left(), 0);
}

TEST_F(ProgressTest, LinesFromSeveralThreadsDoNotMix) {
  Progress progress(ProgressMode::json, json_, text_);
  progress.start(400);
  std::vector<std::thread> writers;
  for (int t = 0; t < 4; ++t)
    writers.emplace_back([&] {
      for (int i = 0; i < 100; ++i) progress.frame_done(i, "frame.exr", 1);
    });
  for (std::thread& writer : writers) writer.join();
  progress.finish();
  const std::vector<json> all = events();
  ASSERT_EQ(all.size(), 402u);
  for (std::size_t i = 1; i <= 400; ++i) EXPECT_EQ(all[i]["done"], i);
}

}  // namespace
}  // namespace sheaf
