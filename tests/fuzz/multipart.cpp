// SPDX-License-Identifier: MIT
// A multipart body. However it is cut into pieces, the same parts come out; names of files are harmless or refused.
#include "upload/multipart.hpp"

#include <algorithm>
#include <optional>
#include <vector>

#include "target.hpp"
#include "upload/safe_path.hpp"
#include "util/problem.hpp"

namespace {

using namespace sheaf;
using namespace sheaf::server;

constexpr std::uint64_t most_parts = 16;

/// What the parser told, or nothing if it refused.
std::optional<std::string> told(std::string_view body, std::size_t piece) {
  std::string all;
  bool open = false;
  std::uint64_t parts = 0;
  try {
    MultipartParser parser(
        "b", most_parts,
        {[&](const PartHeader& part) {
           fuzz::require(!open && ++parts <= most_parts, "parts come one after another, not too many");
           open = true;
           all += "[" + part.name + "|" + part.filename.value_or("-") + "|" + part.content_type + "]";
           if (part.filename) {
             const auto path = safe_relative_path(*part.filename);
             fuzz::require(path.is_relative() && *path.begin() != "..", "files stay in their folder");
           }
         },
         [&](std::string_view bytes) {
           fuzz::require(open, "bytes belong to a part");
           all += bytes;
         },
         [&] {
           fuzz::require(open, "a part ends once");
           open = false;
         }});
    for (std::size_t at = 0; at < body.size(); at += piece) parser.feed(body.substr(at, piece));
    parser.finish();
  } catch (const Problem&) {
    return std::nullopt;
  }
  return all;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view body = fuzz::as_text(data + 1, size - 1);
  const std::size_t piece = 1 + data[0] % 64;
  fuzz::require(told(body, piece) == told(body, std::max<std::size_t>(body.size(), 1)), "pieces make no difference");
  try {
    (void)multipart_boundary(body);
  } catch (const Problem&) {
    // Refused, with a reason.
  }
  return 0;
}
