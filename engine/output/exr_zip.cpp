// SPDX-License-Identifier: MIT
#include "output/exr_zip.hpp"

#include <ImfChannelList.h>
#include <libdeflate.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <memory>
#include <new>
#include <vector>

#include "core/error.hpp"

namespace sheaf {
namespace {

static_assert(std::endian::native == std::endian::little, "samples and lengths are written as they lie in memory");

// libdeflate's fastest. Measured on colour of Sponza at 1280x720, against OpenEXR with zlib: 0.4 of the time of writing
// and 1.01 of the bytes; level 4 takes 0.56 and 0.97, level 6 0.8 and 0.96. With float layers the bytes are the same
// within 1 % at all of them.
constexpr int level = 1;

struct Row {  // a channel's first line
  const char* first;
  std::size_t pixel, line, bytes;  // steps, and of a sample
};

// A chunk's lines one after the other, each channel's samples of a line together.
class Chunks {
 public:
  Chunks(const Imf::Header& header, const Imf::FrameBuffer& pixels)
      : width_(static_cast<std::size_t>(header.dataWindow().max.x) + 1),
        height_(static_cast<std::size_t>(header.dataWindow().max.y) + 1),
        lines_(header.compression() == Imf::ZIPS_COMPRESSION ? 1 : 16) {
    const Imf::ChannelList& channels = header.channels();
    for (auto at = channels.begin(); at != channels.end(); ++at) {
      const Imf::Slice& slice = pixels[at.name()];
      rows_.push_back({slice.base, slice.xStride, slice.yStride, at.channel().type == Imf::HALF ? 2U : 4U});
      line_bytes_ += width_ * rows_.back().bytes;
    }
  }

  [[nodiscard]] std::size_t count() const { return (height_ + lines_ - 1) / lines_; }
  [[nodiscard]] std::size_t first_line(std::size_t chunk) const { return chunk * lines_; }
  [[nodiscard]] std::size_t most_bytes() const { return lines_ * line_bytes_; }

  void gather(std::size_t chunk, std::vector<char>& to) const {
    const std::size_t first = first_line(chunk), end = std::min(first + lines_, height_);
    to.resize((end - first) * line_bytes_);
    char* at = to.data();
    for (std::size_t y = first; y < end; ++y)
      for (const Row& row : rows_) {
        const char* from = row.first + y * row.line;
        if (row.bytes == 2)
          gather_line<std::uint16_t>(from, row.pixel, at);
        else
          gather_line<std::uint32_t>(from, row.pixel, at);
        at += width_ * row.bytes;
      }
  }

 private:
  template <typename Sample>
  void gather_line(const char* from, std::size_t step, char* to) const {
    for (std::size_t x = 0; x < width_; ++x) std::memcpy(to + x * sizeof(Sample), from + x * step, sizeof(Sample));
  }

  std::size_t width_, height_, lines_, line_bytes_ = 0;
  std::vector<Row> rows_;
};

// OpenEXR's preparation: the bytes at even places, then those at odd ones, and of each its difference from the one
// before, plus 128.
void prepare(const std::vector<char>& raw, std::vector<unsigned char>& split, std::vector<unsigned char>& ready) {
  split.resize(raw.size());
  ready.resize(raw.size());
  const std::size_t half = (raw.size() + 1) / 2;
  for (std::size_t i = 0; i < raw.size() / 2; ++i) {
    split[i] = static_cast<unsigned char>(raw[2 * i]);
    split[half + i] = static_cast<unsigned char>(raw[2 * i + 1]);
  }
  if (raw.size() % 2 == 1) split[half - 1] = static_cast<unsigned char>(raw.back());
  ready[0] = split[0];
  for (std::size_t i = 1; i < split.size(); ++i) ready[i] = static_cast<unsigned char>(split[i] - split[i - 1] + 128);
}

template <typename T>
void append(AtomicFile& file, const T& value) {
  file.write(std::as_bytes(std::span(&value, 1)));
}

}  // namespace

void write_zip_chunks(AtomicFile& file, const Imf::Header& header, const Imf::FrameBuffer& pixels) {
  const Chunks chunks(header, pixels);
  const std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> compressor(
      libdeflate_alloc_compressor(level), &libdeflate_free_compressor);
  if (!compressor) throw std::bad_alloc();
  std::vector<std::uint64_t> places(chunks.count());
  const std::uint64_t table = file.tell();
  file.write(std::as_bytes(std::span(places)));

  std::vector<char> raw;
  std::vector<unsigned char> split, ready;
  std::vector<std::byte> packed(chunks.most_bytes());
  for (std::size_t chunk = 0; chunk < chunks.count(); ++chunk) {
    chunks.gather(chunk, raw);
    prepare(raw, split, ready);
    // What does not become smaller is stored as it is, which readers know by its length; then 0 comes back.
    const std::size_t size =
        libdeflate_zlib_compress(compressor.get(), ready.data(), ready.size(), packed.data(), raw.size() - 1);
    places[chunk] = file.tell();
    append(file, static_cast<std::int32_t>(chunks.first_line(chunk)));
    append(file, static_cast<std::int32_t>(size > 0 ? size : raw.size()));
    file.write(size > 0 ? std::span<const std::byte>(packed).first(size) : std::as_bytes(std::span(raw)));
  }
  const std::uint64_t end = file.tell();
  file.seek(table);
  file.write(std::as_bytes(std::span(places)));
  file.seek(end);
}

}  // namespace sheaf
