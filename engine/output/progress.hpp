// SPDX-License-Identifier: MIT
// What `--progress` shows while frames are rendered.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <deque>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>

namespace sheaf {

enum class ProgressMode { automatic, bar, json, none };
constexpr auto choice_names(ProgressMode) { return std::array{"auto", "bar", "json", "none"}; }

/// Bar: percent, frames and time left, on `text`. Json: one object a line on `json`, flushed. Automatic: a bar if
/// `text` is a terminal, else none. Warnings and errors are shown in every mode: as JSON events, else as lines on
/// `text`; an error is a line on `text` in json mode too. Safe to call from several threads.
class Progress {
 public:
  explicit Progress(ProgressMode mode, std::FILE* json = stdout, std::FILE* text = stderr);

  void start(std::size_t frames);
  void frame_done(std::int64_t frame, const std::string& path, double wall_ms);
  void warning(const std::string& message);
  void error(int code, const std::string& message);  // code: the process exit code
  void finish();

  /// Seconds left: the median of the last frames' times, for each frame still to come. 0 before the first frame.
  [[nodiscard]] double seconds_left() const;

 private:
  [[nodiscard]] double estimate() const;
  void emit(const nlohmann::ordered_json& event);
  void say(const std::string& line);
  void draw_bar();
  void clear_bar();

  ProgressMode mode_;
  std::FILE *json_, *text_;
  mutable std::mutex mutex_;
  std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now();
  std::size_t total_ = 0, done_ = 0;
  std::deque<double> recent_ms_;
  bool bar_shown_ = false;
};

}  // namespace sheaf
