// SPDX-License-Identifier: MIT
#include "upload/content_digest.hpp"

#include <algorithm>

#include "util/problem.hpp"

namespace sheaf::server {
namespace {

constexpr std::size_t base64_length = 44;  // of 32 bytes, one '=' at its end

[[noreturn]] void malformed() {
  throw Problem(ProblemKind::malformed_request,
                "Content-Digest: sha-256 must be 44 characters of base64 between colons");
}

unsigned sextet(char c) {
  if (c >= 'A' && c <= 'Z') return static_cast<unsigned>(c - 'A');
  if (c >= 'a' && c <= 'z') return static_cast<unsigned>(c - 'a') + 26;
  if (c >= '0' && c <= '9') return static_cast<unsigned>(c - '0') + 52;
  if (c == '+') return 62;
  if (c == '/') return 63;
  malformed();
}

/// A byte sequence of a structured field (RFC 8941, 3.3.5) as hexadecimal digits.
std::string hex_of(std::string_view value) {
  if (value.size() != base64_length + 2 || value.front() != ':' || value.back() != ':') malformed();
  value = value.substr(1, base64_length);
  if (value.back() != '=') malformed();
  std::string hex;
  unsigned pool = 0, bits = 0;
  for (const char c : value.substr(0, base64_length - 1)) {
    pool = (pool << 6 | sextet(c)) & 0xffff;
    for (bits += 6; bits >= 4; bits -= 4) hex += "0123456789abcdef"[pool >> (bits - 4) & 15];
  }
  if (hex.size() != 64 || (pool & ((1u << bits) - 1)) != 0) malformed();
  return hex;
}

}  // namespace

std::optional<std::string> declared_sha256(const Request& request) {
  const std::string header = request.header("Content-Digest").value_or("");
  std::optional<std::string> found;
  for (std::string_view rest = header; !rest.empty();) {
    const auto end = std::min(rest.find(','), rest.size());
    const std::string_view member = trimmed(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
    const auto equals = member.find('=');
    if (equals == std::string_view::npos) malformed();
    if (member.substr(0, equals) == "sha-256") found = hex_of(member.substr(equals + 1));
  }
  return found;
}

}  // namespace sheaf::server
