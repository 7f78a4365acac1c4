// SPDX-License-Identifier: MIT
#include "sampling/sample_count.hpp"

#include <charconv>
#include <limits>
#include <sstream>

namespace sheaf {
namespace {

template <typename Number>
bool parse_whole(std::string_view text, Number& number) {
  const char* const end = text.data() + text.size();
  const auto [at, failed] = std::from_chars(text.data(), end, number);
  if (failed == std::errc::result_out_of_range && std::numeric_limits<Number>::is_integer)
    number = std::numeric_limits<Number>::max();
  else if (failed != std::errc())
    return false;
  return at == end;
}

}  // namespace

std::optional<SampleCount> parse_sample_count(std::string_view text) {
  constexpr std::string_view adaptive = "adaptive:";
  SampleCount samples;
  if (!text.starts_with(adaptive)) return parse_whole(text, samples.most) ? std::optional(samples) : std::nullopt;
  const std::string_view rest = text.substr(adaptive.size());
  const auto colon = rest.find(':');
  double error = 0;
  samples.most = 256;
  if (!parse_whole(rest.substr(0, colon), error)) return std::nullopt;
  if (colon != std::string_view::npos && !parse_whole(rest.substr(colon + 1), samples.most)) return std::nullopt;
  samples.error = error;
  return samples;
}

std::string text_of(const SampleCount& samples) {
  std::ostringstream text;
  if (samples.error) text << "adaptive:" << *samples.error << ":";
  text << samples.most;
  return text.str();
}

}  // namespace sheaf
