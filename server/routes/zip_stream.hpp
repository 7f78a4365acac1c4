// SPDX-License-Identifier: MIT
// A zip archive made while it is sent: entries stored as they are, sizes and checksums known beforehand, so that its
// length is known too and equal frames give equal bytes. Zip64 fields appear where a number needs them
// (APPNOTE 6.3.10, 4.3 and 4.5.3).
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "http/message.hpp"

namespace sheaf::server {

struct ZipEntry {
  std::string name;  // UTF-8
  std::uint64_t bytes = 0;
  std::uint32_t crc32 = 0;
};

class ZipStream {
 public:
  explicit ZipStream(std::vector<ZipEntry> entries);

  [[nodiscard]] std::uint64_t length() const { return length_; }

  /// `content` sends the bytes of entry `index`. False as soon as `write` or `content` returns false.
  using Content = std::function<bool(std::size_t index, const Writer& write)>;
  [[nodiscard]] bool write(const Writer& write, const Content& content) const;

 private:
  [[nodiscard]] std::string directory() const;

  std::vector<ZipEntry> entries_;
  std::vector<std::uint64_t> offsets_;
  std::uint64_t directory_offset_ = 0, length_ = 0;
};

}  // namespace sheaf::server
