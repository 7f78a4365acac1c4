// SPDX-License-Identifier: MIT
// Reads a request's body, delimited by Content-Length or by chunks (RFC 9112, 7.1). It reads no byte beyond the body,
// and never more than the limit, whatever the client declares.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "http/request_head.hpp"

namespace sheaf::server {

class BodyReader {
 public:
  /// At most `size` bytes, 0 at the end of the connection. May throw.
  using Source = std::function<std::size_t(char* into, std::size_t size)>;

  BodyReader(const RequestHead& head, std::uint64_t limit, Source source);

  /// 0 at the end of the body. Throws Problem: 400 cut off or malformed, 413 past the limit.
  std::size_t read(char* into, std::size_t size);

  [[nodiscard]] bool finished() const { return finished_; }

 private:
  void next_chunk();
  [[nodiscard]] std::string line();
  [[noreturn]] void refuse_size(std::uint64_t size) const;

  Source source_;
  BodyFraming framing_;
  std::uint64_t limit_, total_ = 0;
  std::uint64_t left_;  // of the body, or of the chunk
  bool first_chunk_ = true, finished_ = false;
};

}  // namespace sheaf::server
