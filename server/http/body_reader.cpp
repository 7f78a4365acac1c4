// SPDX-License-Identifier: MIT
#include "http/body_reader.hpp"

#include <algorithm>
#include <charconv>

#include "util/problem.hpp"

namespace sheaf::server {
namespace {

constexpr std::size_t max_chunk_line = 256;    // size and extensions; extensions are ignored
constexpr std::size_t max_trailer_lines = 32;  // ignored too

[[noreturn]] void malformed(const std::string& why) { throw Problem(ProblemKind::malformed_request, "body: " + why); }

std::uint64_t chunk_size(const std::string& line) {
  const std::string_view digits = trimmed(std::string_view(line).substr(0, line.find(';')));
  std::uint64_t size = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), size, 16);
  if (digits.empty() || error != std::errc{} || end != digits.data() + digits.size())
    malformed("a chunk's size is not a hexadecimal number");
  return size;
}

}  // namespace

BodyReader::BodyReader(const RequestHead& head, std::uint64_t limit, Source source)
    : source_(std::move(source)),
      framing_(head.framing),
      limit_(limit),
      left_(head.framing == BodyFraming::length ? head.content_length : 0),
      finished_(head.framing == BodyFraming::none) {}

std::size_t BodyReader::read(char* into, std::size_t size) {
  if (finished_ || size == 0) return 0;
  if (framing_ == BodyFraming::length && total_ + left_ > limit_) refuse_size(total_ + left_);
  if (framing_ == BodyFraming::chunked && left_ == 0) {
    next_chunk();
    if (finished_) return 0;
  }
  const std::size_t n = source_(into, static_cast<std::size_t>(std::min<std::uint64_t>(size, left_)));
  if (n == 0) malformed("the connection ended before the body did");
  left_ -= n;
  total_ += n;
  if (framing_ == BodyFraming::length && left_ == 0) finished_ = true;
  return n;
}

void BodyReader::next_chunk() {
  if (!first_chunk_ && !line().empty()) malformed("a chunk does not end in CRLF");
  first_chunk_ = false;
  left_ = chunk_size(line());
  if (left_ > limit_ || total_ > limit_ - left_) refuse_size(total_ + std::min(left_, limit_));
  if (left_ > 0) return;
  for (std::size_t trailers = 0; !line().empty(); ++trailers)
    if (trailers == max_trailer_lines) malformed("too many trailers");
  finished_ = true;
}

std::string BodyReader::line() {
  std::string text;
  for (char c = 0; source_(&c, 1) == 1;) {
    if (c == '\n') {
      if (text.empty() || text.back() != '\r') malformed("a chunk's line does not end in CRLF");
      text.pop_back();
      return text;
    }
    if (text.size() == max_chunk_line) malformed("a chunk's line is too long");
    text += c;
  }
  malformed("the connection ended before the body did");
}

void BodyReader::refuse_size(std::uint64_t size) const {
  throw Problem(ProblemKind::too_large,
                "the body has at least " + std::to_string(size) + " bytes, the limit is " + std::to_string(limit_))
      .exceeded("max-upload", limit_, size);
}

}  // namespace sheaf::server
