// SPDX-License-Identifier: MIT
#include "output/frame_names.hpp"

#include <algorithm>
#include <filesystem>
#include <string_view>

#include "core/error.hpp"
#include "core/quote.hpp"

namespace sheaf {
namespace {

constexpr std::string_view extension = ".exr";
// File systems allow 255 bytes a name; this leaves room for a longer number and for the temporary name's additions.
constexpr std::size_t max_pattern_bytes = 200;

bool is_control(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }

Error usage(const std::string& pattern, const std::string& reason) {
  return {ErrorKind::usage, "--name " + in_quotes(pattern) + ": " + reason};
}

}  // namespace

FrameNames::FrameNames(const std::string& pattern) : pattern_(pattern) {
  if (std::any_of(pattern.begin(), pattern.end(), is_control))
    throw Error(ErrorKind::usage, "--name: the pattern has a control character in it");
  if (pattern.size() > max_pattern_bytes)
    throw usage(pattern, "longer than " + std::to_string(max_pattern_bytes) + " bytes");
  if (pattern.find('/') != std::string::npos)
    throw usage(pattern, "a frame's name cannot hold '/'; the folder is --out");
  if (!pattern.ends_with(extension)) throw usage(pattern, "does not end in .exr");
  const std::size_t first = pattern.find('#');
  if (first == std::string::npos) throw usage(pattern, "has no run of '#' for the frame number");
  const std::size_t end = pattern.find_first_not_of('#', first);  // found: the extension follows
  if (pattern.find('#', end) != std::string::npos) throw usage(pattern, "has more than one run of '#'");
  before_ = pattern.substr(0, first);
  after_ = pattern.substr(end, pattern.size() - end - extension.size());
  digits_ = end - first;
}

std::string FrameNames::stem(std::int64_t number) const {
  std::string digits = std::to_string(number);
  const std::size_t sign = number < 0 ? 1 : 0;
  if (digits.size() < digits_) digits.insert(sign, digits_ - digits.size(), '0');
  return before_ + digits + after_;
}

std::string FrameNames::frame(std::int64_t number) const { return stem(number) + ".exr"; }

std::string FrameNames::preview(std::int64_t number) const { return stem(number) + ".png"; }

std::string default_name_pattern(const std::string& scene_path) {
  std::string stem = std::filesystem::path(scene_path).stem().string();
  std::replace_if(
      stem.begin(), stem.end(), [](char c) { return c == '#' || is_control(c); }, '_');
  constexpr std::string_view number = ".####";
  std::size_t length = std::min(stem.size(), max_pattern_bytes - number.size() - extension.size());
  // Not in the middle of a UTF-8 character.
  while (length > 0 && length < stem.size() && (static_cast<unsigned char>(stem[length]) & 0xc0) == 0x80) --length;
  stem.resize(length);
  return (stem.empty() ? "frame" : stem) + std::string(number) + std::string(extension);
}

}  // namespace sheaf
