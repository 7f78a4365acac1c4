// SPDX-License-Identifier: MIT
#include "routes/zip_stream.hpp"

#include <algorithm>

namespace sheaf::server {
namespace {

constexpr std::uint64_t full32 = 0xffffffff;  // "see the Zip64 field"
constexpr std::uint64_t full16 = 0xffff;
constexpr std::uint16_t utf8_names = 0x0800;
constexpr std::uint16_t epoch_date = 0x0021;            // 1980-01-01: the same archive for the same frames
constexpr std::uint32_t regular_file = 0100644u << 16;  // Unix mode
constexpr std::uint16_t version_zip64 = 45, version_plain = 20, made_on_unix = 3 << 8;

class Record {
 public:
  Record& u16(std::uint64_t value) { return put(value, 2); }
  Record& u32(std::uint64_t value) { return put(value, 4); }
  Record& u64(std::uint64_t value) { return put(value, 8); }
  Record& capped32(std::uint64_t value) { return u32(std::min(value, full32)); }
  Record& text(const std::string& bytes) {
    bytes_ += bytes;
    return *this;
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  Record& put(std::uint64_t value, int count) {
    for (int i = 0; i < count; ++i) bytes_ += static_cast<char>(value >> (8 * i) & 0xff);
    return *this;
  }
  std::string bytes_;
};

/// Zip64 extended information: only the numbers that do not fit, in this order.
std::string zip64_field(const std::vector<std::uint64_t>& numbers) {
  if (numbers.empty()) return {};
  Record field;
  field.u16(1).u16(numbers.size() * 8);
  for (const std::uint64_t number : numbers) field.u64(number);
  return field.bytes();
}

bool is_large(std::uint64_t value) { return value >= full32; }

std::string local_header(const ZipEntry& entry) {
  const bool large = is_large(entry.bytes);
  const std::string extra = zip64_field(large ? std::vector{entry.bytes, entry.bytes} : std::vector<std::uint64_t>{});
  Record header;
  header.u32(0x04034b50).u16(large ? version_zip64 : version_plain).u16(utf8_names).u16(0).u16(0).u16(epoch_date);
  header.u32(entry.crc32).capped32(entry.bytes).capped32(entry.bytes);
  header.u16(entry.name.size()).u16(extra.size()).text(entry.name).text(extra);
  return header.bytes();
}

std::string central_header(const ZipEntry& entry, std::uint64_t offset) {
  std::vector<std::uint64_t> large;
  if (is_large(entry.bytes)) large = {entry.bytes, entry.bytes};
  if (is_large(offset)) large.push_back(offset);
  const std::string extra = zip64_field(large);
  const std::uint16_t version = large.empty() ? version_plain : version_zip64;
  Record header;
  header.u32(0x02014b50).u16(made_on_unix | version).u16(version).u16(utf8_names).u16(0).u16(0).u16(epoch_date);
  header.u32(entry.crc32).capped32(entry.bytes).capped32(entry.bytes);
  header.u16(entry.name.size()).u16(extra.size()).u16(0).u16(0).u16(0).u32(regular_file).capped32(offset);
  header.text(entry.name).text(extra);
  return header.bytes();
}

}  // namespace

ZipStream::ZipStream(std::vector<ZipEntry> entries) : entries_(std::move(entries)) {
  for (const ZipEntry& entry : entries_) {
    offsets_.push_back(directory_offset_);
    directory_offset_ += local_header(entry).size() + entry.bytes;
  }
  length_ = directory_offset_ + directory().size();
}

std::string ZipStream::directory() const {
  Record all;
  for (std::size_t i = 0; i < entries_.size(); ++i) all.text(central_header(entries_[i], offsets_[i]));
  const std::uint64_t size = all.bytes().size(), count = entries_.size(), end = directory_offset_ + size;
  if (count >= full16 || is_large(size) || is_large(directory_offset_)) {
    all.u32(0x06064b50).u64(44).u16(made_on_unix | version_zip64).u16(version_zip64).u32(0).u32(0);
    all.u64(count).u64(count).u64(size).u64(directory_offset_);
    all.u32(0x07064b50).u32(0).u64(end).u32(1);
  }
  const std::uint64_t shown = std::min(count, full16);
  all.u32(0x06054b50).u16(0).u16(0).u16(shown).u16(shown).capped32(size).capped32(directory_offset_).u16(0);
  return all.bytes();
}

bool ZipStream::write(const Writer& write, const Content& content) const {
  for (std::size_t i = 0; i < entries_.size(); ++i)
    if (!write(local_header(entries_[i])) || !content(i, write)) return false;
  return write(directory());
}

}  // namespace sheaf::server
