// SPDX-License-Identifier: MIT
// A streaming parser of multipart/form-data (RFC 7578), fed in pieces of any size. Strict about delimiters, one name
// per part, and bounded headers; ignores preamble, epilogue and other headers.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace sheaf::server {

struct PartHeader {
  std::string name, content_type;
  std::optional<std::string> filename;
};

struct PartHandler {
  std::function<void(const PartHeader&)> begin;
  std::function<void(std::string_view)> data;
  std::function<void()> end;
};

class MultipartParser {
 public:
  MultipartParser(const std::string& boundary, std::uint64_t max_parts, PartHandler handler);

  /// Throws Problem (400).
  void feed(std::string_view bytes);

  /// The body has ended: throws Problem (400) unless it had its closing delimiter.
  void finish() const;

 private:
  enum class State { preamble, delimiter, headers, body, epilogue };
  bool step();
  bool skip_to_delimiter();
  bool read_delimiter();
  bool read_headers();
  bool read_body();

  std::string delimiter_;  // CRLF "--" boundary
  std::uint64_t parts_left_, max_parts_;
  PartHandler handler_;
  State state_ = State::preamble;
  std::string buffer_ = "\r\n";  // so that a delimiter on the first line is like any other
};

/// Boundary of a multipart/form-data content type; nothing if it is another type. Throws Problem (400) if it has none.
[[nodiscard]] std::optional<std::string> multipart_boundary(std::string_view content_type);

/// Content-Disposition and Content-Type out of a part's header lines. Throws Problem (400).
[[nodiscard]] PartHeader parse_part_header(std::string_view lines);

}  // namespace sheaf::server
