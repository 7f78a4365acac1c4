// SPDX-License-Identifier: MIT
#include "output/progress.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/error.hpp"

namespace sheaf {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t remembered_frames = 15;
constexpr std::size_t bar_width = 28;

ProgressMode resolved(ProgressMode mode, std::FILE* text) {
  if (mode != ProgressMode::automatic) return mode;
  return isatty(fileno(text)) == 1 ? ProgressMode::bar : ProgressMode::none;
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::string two_digits(long long value) { return (value < 10 ? "0" : "") + std::to_string(value); }

std::string clock_text(double seconds) {
  const long long whole = std::llround(std::min(seconds, 1e9));
  const std::string minutes_seconds = two_digits(whole / 60 % 60) + ":" + two_digits(whole % 60);
  return whole < 3600 ? minutes_seconds : std::to_string(whole / 3600) + ":" + minutes_seconds;
}

}  // namespace

Progress::Progress(ProgressMode mode, std::FILE* json, std::FILE* text)
    : mode_(resolved(mode, text)), json_(json), text_(text) {}

void Progress::start(std::size_t frames) {
  const std::lock_guard lock(mutex_);
  started_ = std::chrono::steady_clock::now();
  total_ = frames;
  done_ = 0;
  recent_ms_.clear();
  emit({{"event", "start"}, {"frames", frames}, {"version", SHEAF_VERSION}});
  draw_bar();
}

void Progress::frame_done(std::int64_t frame, const std::string& path, double wall_ms) {
  const std::lock_guard lock(mutex_);
  ++done_;
  recent_ms_.push_back(wall_ms);
  if (recent_ms_.size() > remembered_frames) recent_ms_.pop_front();
  emit({{"event", "frame"},
        {"frame", frame},
        {"done", done_},
        {"total", total_},
        {"wall_ms", wall_ms},
        {"eta_s", estimate()},
        {"file", path}});
  draw_bar();
}

void Progress::warning(const std::string& message) {
  const std::lock_guard lock(mutex_);
  if (mode_ == ProgressMode::json)
    emit({{"event", "warning"}, {"message", message}});
  else
    say("sheaf: warning: " + message);
}

void Progress::error(int code, const std::string& message) {
  const std::lock_guard lock(mutex_);
  emit({{"event", "error"}, {"code", code}, {"message", message}});
  say("sheaf: " + message);
}

void Progress::finish() {
  const std::lock_guard lock(mutex_);
  emit({{"event", "done"}, {"frames", done_}, {"wall_s", seconds_since(started_)}});
  if (bar_shown_) std::fputc('\n', text_);
  bar_shown_ = false;
  std::fflush(text_);
}

double Progress::seconds_left() const {
  const std::lock_guard lock(mutex_);
  return estimate();
}

double Progress::estimate() const {
  if (recent_ms_.empty() || done_ >= total_) return 0;
  std::vector<double> times(recent_ms_.begin(), recent_ms_.end());
  const auto middle = times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2);
  std::nth_element(times.begin(), middle, times.end());
  return *middle * static_cast<double>(total_ - done_) / 1000;
}

void Progress::emit(const Json& event) {
  if (mode_ != ProgressMode::json) return;
  const std::string line = event.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
  std::fwrite(line.data(), 1, line.size(), json_);
  std::fflush(json_);
}

// One line, with the bar, if there is one, moved below it.
void Progress::say(const std::string& line) {
  const bool redraw = bar_shown_;
  clear_bar();
  std::fprintf(text_, "%s\n", line.c_str());
  if (redraw) draw_bar();
  std::fflush(text_);
}

void Progress::draw_bar() {
  if (mode_ != ProgressMode::bar) return;
  const double part = total_ > 0 ? std::min(1.0, static_cast<double>(done_) / static_cast<double>(total_)) : 1;
  std::string bar(static_cast<std::size_t>(part * bar_width), '=');
  if (bar.size() < bar_width) bar += '>';
  bar.resize(bar_width, ' ');
  const std::string left = done_ > 0 && done_ < total_ ? "  " + clock_text(estimate()) + " left" : "";
  clear_bar();
  // Rounded down, so that 100 % means done.
  std::fprintf(text_, "[%s] %3d%%  %zu/%zu frames%s", bar.c_str(), static_cast<int>(part * 100), done_, total_,
               left.c_str());
  std::fflush(text_);
  bar_shown_ = true;
}

void Progress::clear_bar() {
  if (bar_shown_) std::fputs("\r\x1b[K", text_);  // to the line's start, erase to its end
  bar_shown_ = false;
}

}  // namespace sheaf
