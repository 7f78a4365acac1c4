// SPDX-License-Identifier: MIT
#include "upload/safe_path.hpp"

#include <algorithm>

#include "core/quote.hpp"
#include "util/problem.hpp"

namespace sheaf::server {
namespace {

constexpr std::size_t max_path = 1024, max_part = 255, max_depth = 16;

[[noreturn]] void refuse(std::string_view given, const std::string& why) {
  throw Problem(ProblemKind::bad_scene, "file name '" + quote(given) + "': " + why);
}

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

void check_part(std::string_view given, std::string_view part) {
  if (part.empty()) refuse(given, "has an empty part");
  if (part == "..") refuse(given, "has a part '..'");
  if (part.size() > max_part) refuse(given, "has a part of more than 255 bytes");
  if (std::ranges::any_of(part, [](char c) { return static_cast<unsigned char>(c) < 32 || c == 127; }))
    refuse(given, "holds a control character");
}

}  // namespace

std::filesystem::path safe_relative_path(std::string_view given) {
  if (given.empty()) refuse(given, "is empty");
  if (given.size() > max_path) refuse(given, "has more than 1024 bytes");
  std::string name(given);
  std::ranges::replace(name, '\\', '/');
  if (name.front() == '/' || (name.size() > 1 && is_letter(name[0]) && name[1] == ':')) refuse(given, "is absolute");
  std::filesystem::path path;
  std::size_t depth = 0;
  for (std::size_t at = 0; at <= name.size();) {
    const auto end = std::min(name.find('/', at), name.size());
    const std::string_view part = std::string_view(name).substr(at, end - at);
    at = end + 1;
    if (part == ".") continue;
    check_part(given, part);
    if (++depth > max_depth) refuse(given, "is deeper than 16 folders");
    path /= part;
  }
  if (path.empty()) refuse(given, "names no file");
  return path;
}

std::string base_name(std::string_view given) {
  const auto slash = given.find_last_of("/\\");
  return std::string(slash == std::string_view::npos ? given : given.substr(slash + 1));
}

std::string extension_of(std::string_view name) {
  const auto dot = name.rfind('.');
  if (dot == std::string_view::npos) return {};
  std::string extension(name.substr(dot));
  for (char& c : extension)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c + 32);
  return extension;
}

}  // namespace sheaf::server
