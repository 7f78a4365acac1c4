// SPDX-License-Identifier: MIT
// A request: its head, its target, and a body counted by length or by chunks, in pieces of any size.
#include <algorithm>
#include <array>
#include <cstring>

#include "http/body_reader.hpp"
#include "http/request_head.hpp"
#include "target.hpp"
#include "util/problem.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sheaf;
  using namespace sheaf::server;
  if (size == 0) return 0;
  const std::size_t piece = 1 + data[0] % 32;
  const std::string_view text = fuzz::as_text(data + 1, size - 1);
  const auto end = text.find("\r\n\r\n");
  if (end == std::string_view::npos) return 0;
  std::string_view rest = text.substr(end + 4);
  constexpr std::uint64_t limit = 512;
  try {
    const RequestHead head = parse_request_head(text.substr(0, end + 4), {});
    fuzz::require(head.headers.size() <= HeadLimits{}.fields, "the limit of headers holds");
    BodyReader body(head, limit, [&](char* into, std::size_t most) {
      const std::size_t n = std::min({most, piece, rest.size()});
      std::memcpy(into, rest.data(), n);
      rest.remove_prefix(n);
      return n;
    });
    std::array<char, 100> block{};
    std::uint64_t total = 0;
    while (const std::size_t n = body.read(block.data(), block.size())) total += n;
    fuzz::require(total <= limit && body.finished(), "the limit of the body holds");
    std::string path;
    std::vector<std::pair<std::string, std::string>> query;
    split_target(head.target, path, query);
    fuzz::require(path.find('\0') == std::string::npos, "a path has no zero byte");
  } catch (const Problem&) {
    // Refused, with a reason.
  }
  return 0;
}
