// SPDX-License-Identifier: MIT
#include "scene/gltf_image.hpp"

#include <stb/stb_image.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <limits>
#include <memory>
#include <mutex>
#include <string_view>
#include <thread>

#include "scene/image_codec.hpp"

namespace sheaf {
namespace {

using Bytes = std::span<const std::uint8_t>;

// The kind of file, by its first bytes: mimeType is often wrong.
const char* format_of(Bytes bytes) {
  const std::string_view head(reinterpret_cast<const char*>(bytes.data()), std::min<std::size_t>(bytes.size(), 12));
  if (head.starts_with("\x89PNG")) return "PNG";
  if (head.starts_with("\xff\xd8\xff")) return "JPEG";
  if (head.starts_with("\xabKTX 20")) return "KTX2";
  if (head.starts_with("\xabKTX")) return "KTX";
  if (head.starts_with("DDS ")) return "DDS";
  if (head.starts_with("RIFF") && head.substr(8) == "WEBP") return "WebP";
  if (head.size() == 12 && head.substr(4).starts_with("ftypavi")) return "AVIF";
  if (head.starts_with("GIF8")) return "GIF";
  if (head.starts_with("BM")) return "BMP";
  return "unknown";
}

// How formats other than PNG and JPEG are read, and without which library they cannot be.
struct Codec {
  std::string_view format;
  ReadImageHead head = nullptr;
  DecodeImage decode = nullptr;
  const char* lacks = nullptr;
};

constexpr Codec codecs[] = {
    {"KTX2", read_ktx2_head, decode_ktx2},
    {"DDS", read_dds_head, decode_dds},
#ifdef SHEAF_HAS_WEBP
    {"WebP", read_webp_head, decode_webp},
#else
    {"WebP", nullptr, nullptr, "libwebp"},
#endif
};

const Codec* codec_of(std::string_view format) {
  const auto* const found = std::ranges::find(codecs, format, &Codec::format);
  return found == std::end(codecs) ? nullptr : found;
}

// A chunk of texels in a PNG that claims more bytes than there are: stb_image takes memory for all that it claims.
bool has_overlong_texels(Bytes png) {
  const auto word = [&](std::size_t at) {
    return std::uint64_t{png[at]} << 24 | png[at + 1] << 16 | png[at + 2] << 8 | png[at + 3];
  };
  constexpr std::uint64_t texels = 0x49444154, chunk_overhead = 12;  // IDAT; length, type and checksum
  for (std::uint64_t at = 8; at + 8 <= png.size(); at += word(at) + chunk_overhead)
    if (word(at + 4) == texels && word(at) > png.size() - at - 8) return true;
  return false;
}

ImageHead read_stb_head(Bytes bytes, const std::string& format) {
  if (format == "PNG" && has_overlong_texels(bytes)) return {0, 0, "cannot be decoded: it is damaged"};
  int width = 0, height = 0, channels = 0;
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()) ||
      !stbi_info_from_memory(bytes.data(), static_cast<int>(bytes.size()), &width, &height, &channels) || width <= 0 ||
      height <= 0)
    return {0, 0, "is not a valid " + format + " file"};
  return {static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), {}};
}

// Checks the header, so that what decoding will allocate is known before it starts.
std::uint64_t decoded_size(const GltfFile& file, std::uint32_t index) {
  const Bytes bytes = file.bytes->image(file, index);
  const std::string place = at("images", index);
  if (bytes.empty()) file.fail(place, "is empty");
  const std::string format = format_of(bytes);
  const Codec* const codec = codec_of(format);
  if (codec == nullptr && format != "PNG" && format != "JPEG") file.fail(place, format + " images are not supported");
  if (codec != nullptr && codec->lacks != nullptr)
    file.fail(place, format + " images are not supported: this build lacks " + codec->lacks);
  const ImageHead head = codec != nullptr ? codec->head(bytes) : read_stb_head(bytes, format);
  if (!head.fault.empty()) file.fail(place, head.fault);
  const std::uint32_t most = file.limits.image_side;
  if (head.width > most || head.height > most) {
    file.over_limit(place, std::to_string(head.width) + " x " + std::to_string(head.height) +
                               " pixels, a side may have " + std::to_string(most));
  }
  return std::uint64_t{head.width} * head.height * 4;
}

// stb_image keeps a thread's last reason and gives none for some failures: what it says of no bytes at all stands for
// those.
const char* no_reason() {
  const stbi_uc nothing = 0;
  int width = 0, height = 0, channels = 0;
  (void)stbi_info_from_memory(&nothing, 0, &width, &height, &channels);
  return stbi_failure_reason();
}

// Why it cannot be decoded, or nothing.
std::string decode_stb(Bytes bytes, Image& image) {
  const char* const none = no_reason();
  int width = 0, height = 0, channels = 0;
  const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
      stbi_load_from_memory(bytes.data(), static_cast<int>(bytes.size()), &width, &height, &channels, 4),
      &stbi_image_free);
  if (!pixels) {
    const char* const reason = stbi_failure_reason();
    return std::string("cannot be decoded: ") + (reason == none ? "it is damaged" : reason);
  }
  image.width = static_cast<std::uint32_t>(width);
  image.height = static_cast<std::uint32_t>(height);
  image.rgba.assign(pixels.get(), pixels.get() + std::size_t{image.width} * image.height * 4);
  return {};
}

Image decode(const GltfFile& file, std::uint32_t index) {
  const Bytes bytes = file.bytes->image(file, index);  // `decoded_size` asked first: no thread reads a file
  Image image;
  const nlohmann::json& source = file.json["images"][index];
  image.name = source.value("name", source.value("uri", ""));
  std::string fault;
  if (const Codec* const codec = codec_of(format_of(bytes))) {
    const ImageHead head = codec->head(bytes);
    image.width = head.width;
    image.height = head.height;
    fault = codec->decode(bytes, image);
  } else {
    fault = decode_stb(bytes, image);
  }
  if (!fault.empty()) file.fail(at("images", index), fault);
  return image;
}

}  // namespace

std::vector<Image> decode_images(const GltfFile& file, const std::vector<std::uint32_t>& images) {
  std::uint64_t total = 0;
  for (const std::uint32_t index : images) {
    total += decoded_size(file, index);
    if (total > file.limits.texture_bytes) {
      file.over_limit(at("images", index),
                      "the decoded images exceed " + std::to_string(file.limits.texture_bytes) + " bytes");
    }
  }

  std::vector<Image> decoded(images.size());
  std::vector<std::exception_ptr> errors(
      images.size());  // the first in the file's order is thrown, whoever met it first
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < images.size(); i = next++) {
      try {
        decoded[i] = decode(file, images[i]);
      } catch (...) {
        errors[i] = std::current_exception();
      }
    }
  };
  {
    const std::size_t count = std::clamp<std::size_t>(std::thread::hardware_concurrency(), 1, 8);
    std::vector<std::jthread> threads;
    for (std::size_t t = 1; t < std::min(count, images.size()); ++t) threads.emplace_back(work);
    work();
  }
  for (const std::exception_ptr& error : errors) {
    if (error) std::rethrow_exception(error);
  }
  return decoded;
}

}  // namespace sheaf
