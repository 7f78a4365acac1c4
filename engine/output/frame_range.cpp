// SPDX-License-Identifier: MIT
#include "output/frame_range.hpp"

#include <charconv>
#include <string_view>
#include <system_error>
#include <unordered_set>

#include "core/error.hpp"
#include "core/quote.hpp"

namespace sheaf {
namespace {

struct Range {
  std::int64_t first, last, step;
  [[nodiscard]] std::size_t count() const { return static_cast<std::size_t>((last - first) / step) + 1; }
};

Error usage(std::string_view item, const std::string& reason) {
  return {ErrorKind::usage, "--frames " + in_quotes(item) + ": " + reason};
}

// Takes one number off the front of `rest`.
std::int64_t take_number(std::string_view& rest, std::string_view item, const char* what) {
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), number);
  if (error == std::errc::invalid_argument) throw usage(item, std::string(what) + " is not a number");
  if (error != std::errc{} || number > max_frame_number || number < -max_frame_number)
    throw usage(item, std::string(what) + " is beyond ±" + std::to_string(max_frame_number));
  rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
  return number;
}

Range parse_item(std::string_view item) {
  if (item.empty()) throw usage(item, "an empty item; expected N, A-B or A-B:STEP, separated by commas");
  std::string_view rest = item;
  Range range{0, 0, 1};
  range.first = range.last = take_number(rest, item, "the frame");
  if (rest.empty()) return range;
  if (rest.front() != '-') throw usage(item, "expected N, A-B or A-B:STEP");
  rest.remove_prefix(1);
  range.last = take_number(rest, item, "the last frame");
  if (range.last < range.first) throw usage(item, "the last frame is before the first");
  if (rest.empty()) return range;
  if (rest.front() != ':') throw usage(item, "expected N, A-B or A-B:STEP");
  rest.remove_prefix(1);
  range.step = take_number(rest, item, "the step");
  if (range.step < 1) throw usage(item, "the step must be 1 or more");
  if (!rest.empty()) throw usage(item, "text after the step");
  return range;
}

}  // namespace

std::vector<std::int64_t> parse_frames(const std::string& text) {
  std::vector<std::int64_t> frames;
  std::unordered_set<std::int64_t> seen;
  std::size_t listed = 0;  // repeats counted, so that the work is bounded too
  std::string_view rest = text;
  while (true) {
    const std::size_t comma = rest.find(',');
    const std::string_view item = rest.substr(0, comma);
    const Range range = parse_item(item);
    listed += range.count();
    if (listed > max_frames) throw usage(item, "more than " + std::to_string(max_frames) + " frames in all");
    for (std::int64_t frame = range.first; frame <= range.last; frame += range.step)
      if (seen.insert(frame).second) frames.push_back(frame);
    if (comma == std::string_view::npos) return frames;
    rest.remove_prefix(comma + 1);
  }
}

}  // namespace sheaf
