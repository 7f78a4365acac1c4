// SPDX-License-Identifier: MIT
#include "sampling/quality.hpp"

#include <algorithm>
#include <charconv>
#include <sstream>

namespace sheaf {
namespace {

template <typename Number>
bool parse_whole(std::string_view text, Number& number) {
  const char* const end = text.data() + text.size();
  const auto [at, failed] = std::from_chars(text.data(), end, number);
  return failed == std::errc() && at == end;
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

const Quality* find_quality(std::string_view name) {
  const auto found = std::ranges::find_if(qualities, [&](const Quality& q) { return name == q.name; });
  return found == qualities.end() ? nullptr : &*found;
}

}  // namespace sheaf
