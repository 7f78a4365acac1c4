// SPDX-License-Identifier: MIT
#include "settings/values.hpp"

#include <charconv>
#include <cmath>
#include <cstdlib>

#include "core/error.hpp"
#include "output/frame_names.hpp"
#include "output/frame_range.hpp"
#include "sampling/adaptive_pixels.hpp"

namespace sheaf {
namespace {

std::string plain(double value) {
  std::array<char, 32> text{};
  const bool whole = std::abs(value) < 1e15 && value == std::trunc(value);
  const auto end = whole ? std::to_chars(text.begin(), text.end(), static_cast<std::int64_t>(value)).ptr
                         : std::to_chars(text.begin(), text.end(), value).ptr;
  return {text.data(), end};
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

/// The reason of an error that is thrown by what owns the syntax.
template <typename Parse>
std::string reason_of(const Parse& parse) {
  try {
    parse();
    return {};
  } catch (const Error& error) {
    return error.what();
  }
}

}  // namespace

std::string outside_range(double value, const Range& range) {
  if (!range.bounded()) return {};
  if (value <= range.high && (range.above ? value > range.low : value >= range.low)) return {};  // not of a NaN
  if (range.above) return "must be above " + plain(range.low) + " and at most " + plain(range.high);
  return "must be between " + plain(range.low) + " and " + plain(range.high);
}

std::string one_of(std::span<const char* const> choices) {
  std::string text = "must be one of ";
  for (const char* choice : choices) text += (choice == choices.front() ? "" : ", ") + std::string(choice);
  return text;
}

bool read_number(std::string_view text, double& number) {
  if (text.starts_with('+')) text.remove_prefix(1);
  const char* const end = text.data() + text.size();
  const auto [at, failed] = std::from_chars(text.data(), end, number);
  if (failed == std::errc::result_out_of_range) number = std::strtod(std::string(text).c_str(), nullptr);
  return at == end && failed != std::errc::invalid_argument && !text.starts_with('+');
}

double short_double(float value) {
  if (!std::isfinite(value)) return value;
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.begin(), text.end(), value).ptr;
  double number = 0;
  std::from_chars(text.data(), end, number);
  return number;
}

std::string read_whole(std::string_view text, std::uint64_t most, std::uint64_t& value) {
  const char* const end = text.data() + text.size();
  const auto [at, failed] = std::from_chars(text.data(), end, value);
  if (at != end || failed == std::errc::invalid_argument) return "must be a whole number";
  if (failed == std::errc::result_out_of_range || value > most) value = most;  // out of any range that has a bound
  return {};
}

std::string Value<bool>::read(std::string_view text, bool& value) {
  if (text != "true" && text != "false") return "must be true or false";
  value = text == "true";
  return {};
}

std::string Value<NumberOrInfinity>::read(std::string_view text, NumberOrInfinity& value) {
  double wide = 0;
  if (!read_number(text, wide) || std::isnan(wide)) return "must be a number or inf";
  const bool too_large = std::abs(wide) > std::numeric_limits<float>::max() && text.find_first_of("iI") == text.npos;
  value.value = too_large ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(wide);
  return {};
}

nlohmann::ordered_json Value<NumberOrInfinity>::show(const NumberOrInfinity& value) {
  if (std::isinf(value.value)) return value.value > 0 ? "inf" : "-inf";
  return short_double(value.value);
}

std::string Value<NumberOrInfinity>::outside(const NumberOrInfinity& value, const Range& range) {
  return std::isnan(value.value) ? "must be at most 3.4e38, or inf" : outside_range(value.value, range);
}

std::string Value<FrameList>::read(std::string_view text, FrameList& value) {
  value.assign(text);
  return reason_of([&] { (void)parse_frames(value); });
}

std::uint64_t Value<FrameList>::amount(const FrameList& value) { return parse_frames(value).size(); }

std::string Value<FramePattern>::read(std::string_view text, FramePattern& value) {
  value.assign(text);
  return reason_of([&] { (void)FrameNames(value); });
}

std::string Value<Rate>::read(std::string_view text, Rate& value) {
  const auto slash = text.find('/');
  double rate = 0, divisor = 1;
  if (!read_number(text.substr(0, slash), rate) ||
      (slash != std::string_view::npos && !read_number(text.substr(slash + 1), divisor)))
    return "must be a number, or a fraction such as 24000/1001";
  value.emplace(rate / divisor);
  return {};
}

std::string Value<SampleCount>::read(std::string_view text, SampleCount& value) {
  const auto samples = parse_sample_count(text);
  if (!samples) return "must be a whole number or adaptive:ERROR[:MOST]";
  value = *samples;
  return {};
}

nlohmann::ordered_json Value<SampleCount>::show(const SampleCount& value) {
  return value.error ? nlohmann::ordered_json(text_of(value)) : nlohmann::ordered_json(value.most);
}

std::string Value<SampleCount>::outside(const SampleCount& value, const Range& range) {
  constexpr Range errors{1e-5, 1};
  if (value.error) {
    if (std::string reason = outside_range(*value.error, errors); !reason.empty()) return "ERROR " + reason;
    const Range most{2.0 * AdaptivePixels::first_round, range.high};
    if (std::string reason = outside_range(value.most, most); !reason.empty()) return "MOST " + reason;
  }
  return outside_range(value.most, range);
}

std::string Value<ImageSize>::read(std::string_view text, ImageSize& value) {
  const auto cross = text.find('x');
  const char* const end = text.data() + text.size();
  const char* const middle = cross == std::string_view::npos ? end : text.data() + cross;
  if (middle != end) {
    const auto width = std::from_chars(text.data(), middle, value.width);
    const auto height = std::from_chars(middle + 1, end, value.height);
    if (width.ptr == middle && height.ptr == end && width.ec == std::errc() && height.ec == std::errc()) return {};
  }
  return "must be WIDTHxHEIGHT in pixels, for example 1280x720";
}

nlohmann::ordered_json Value<ImageSize>::show(const ImageSize& value) {
  return std::to_string(value.width) + "x" + std::to_string(value.height);
}

std::string Value<ImageSize>::outside(const ImageSize& value, const Range& range) {
  std::string reason = outside_range(value.width, range);
  if (!reason.empty()) return "the width " + reason;
  reason = outside_range(value.height, range);
  return reason.empty() ? reason : "the height " + reason;
}

std::string Value<std::optional<glm::vec3>>::read(std::string_view text, std::optional<glm::vec3>& value) {
  glm::vec3 color(0);
  for (int c = 0; c < 3; ++c) {
    const auto comma = text.find(',');
    double component = 0;
    if ((comma == std::string_view::npos) != (c == 2) || !read_number(trimmed(text.substr(0, comma)), component))
      return "must be R,G,B";
    color[c] = static_cast<float>(component);
    text.remove_prefix(c == 2 ? text.size() : comma + 1);
  }
  value = color;
  return {};
}

nlohmann::ordered_json Value<std::optional<glm::vec3>>::show(const std::optional<glm::vec3>& value) {
  if (!value) return nullptr;
  return {short_double(value->x), short_double(value->y), short_double(value->z)};
}

std::string Value<std::optional<glm::vec3>>::outside(const std::optional<glm::vec3>& value, const Range& range) {
  for (int c = 0; value && c < 3; ++c)
    if (std::string reason = outside_range((*value)[c], range); !reason.empty()) return reason;
  return {};
}

std::string Value<LayerSet>::read(std::string_view text, LayerSet& value) {
  return reason_of([&] { value = parse_layers(std::string(text)); });
}

nlohmann::ordered_json Value<LayerSet>::show(const LayerSet& value) {
  std::string list;
  for (const LayerName& layer : layer_names)
    if (value.*layer.layer) list += (list.empty() ? "" : ",") + std::string(layer.name);
  return list.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(list);
}

}  // namespace sheaf
