// SPDX-License-Identifier: MIT
// Is a frame on disk whole? OpenEXR's isComplete() looks at the chunk table alone, which stands at the front of the
// file: a copy that was cut short passes. So every chunk is read and decoded, a strip at a time.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "output/exr_writer.hpp"

namespace sheaf {
namespace {

constexpr int strip_lines = 256;         // a multiple of every compression's chunk
constexpr std::size_t sample_bytes = 4;  // of the widest type

bool has_size(const Imf::Header& header, std::uint32_t width, std::uint32_t height) {
  const Imath::Box2i& window = header.dataWindow();
  return window == header.displayWindow() && window.min == Imath::V2i(0, 0) && window.max.x >= 0 && window.max.y >= 0 &&
         static_cast<std::uint32_t>(window.max.x) + 1 == width &&
         static_cast<std::uint32_t>(window.max.y) + 1 == height;
}

bool has_plain_channels(const Imf::Header& header) {
  const Imf::ChannelList& channels = header.channels();
  for (auto channel = channels.begin(); channel != channels.end(); ++channel)
    if (channel.channel().xSampling != 1 || channel.channel().ySampling != 1) return false;
  return channels.begin() != channels.end();
}

// Every channel into the same scratch lines: only that it decodes matters.
void decode(Imf::InputFile& file, int width, int height) {
  const std::size_t line_bytes = static_cast<std::size_t>(width) * sample_bytes;
  const int lines = std::min(height, strip_lines);
  std::vector<char> scratch(static_cast<std::size_t>(lines) * line_bytes);
  for (int top = 0; top < height; top += lines) {
    Imf::FrameBuffer strip;
    const Imf::ChannelList& channels = file.header().channels();
    for (auto channel = channels.begin(); channel != channels.end(); ++channel)
      strip.insert(channel.name(), Imf::Slice::Make(channel.channel().type, scratch.data(), Imath::V2i(0, top), width,
                                                    lines, sample_bytes, line_bytes));
    file.setFrameBuffer(strip);
    file.readPixels(top, std::min(top + lines, height) - 1);
  }
}

}  // namespace

bool exr_is_whole(const std::string& path, std::uint32_t width, std::uint32_t height) noexcept {
  try {
    if (!std::filesystem::is_regular_file(path)) return false;  // nor waits for the writer of a FIFO
    constexpr int threads = 0;
    Imf::InputFile file(path.c_str(), threads);
    const Imf::Header& header = file.header();
    if (header.hasTileDescription() || !has_size(header, width, height) || !has_plain_channels(header)) return false;
    if (!file.isComplete()) return false;
    decode(file, static_cast<int>(width), static_cast<int>(height));
    return true;
  } catch (...) {  // whatever is wrong with it, it is to be rendered again
    return false;
  }
}

}  // namespace sheaf
