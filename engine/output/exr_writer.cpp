// SPDX-License-Identifier: MIT
#include "output/exr_writer.hpp"

#include <ImfChannelList.h>
#include <ImfDoubleAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfFramesPerSecond.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfIntAttribute.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <half.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <span>

#include "core/error.hpp"
#include "output/atomic_file.hpp"
#include "output/exr_zip.hpp"

namespace sheaf {
namespace {

constexpr std::array imf_compressions{Imf::NO_COMPRESSION,  Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION,
                                      Imf::ZIP_COMPRESSION, Imf::PIZ_COMPRESSION, Imf::DWAA_COMPRESSION};

class AtomicStream : public Imf::OStream {
 public:
  AtomicStream(AtomicFile& file, const std::string& path) : OStream(path.c_str()), file_(file) {}
  void write(const char bytes[], int count) override {
    file_.write(std::as_bytes(std::span(bytes, static_cast<std::size_t>(count))));
  }
  std::uint64_t tellp() override { return file_.tell(); }
  void seekp(std::uint64_t position) override { file_.seek(position); }

 private:
  AtomicFile& file_;
};

// Channels of one file with the memory they are written from. OpenEXR takes pointers to mutable pixels, which it only
// reads when writing.
class Channels {
 public:
  Channels(const FrameLayers& layers, Imf::Header& header) : width_(layers.width), header_(header) {
    if (!layers.rgba.empty()) add({"R", "G", "B", "A"}, Imf::HALF, rgba_ = to_half(layers.rgba));
    add({"Z"}, Imf::FLOAT, layers.depth);
    add({"N.X", "N.Y", "N.Z"}, Imf::FLOAT, layers.normal);
    add({"P.X", "P.Y", "P.Z"}, Imf::FLOAT, layers.position);
    if (!layers.albedo.empty()) add({"albedo.R", "albedo.G", "albedo.B"}, Imf::HALF, albedo_ = to_half(layers.albedo));
    add({"UV.X", "UV.Y"}, Imf::FLOAT, layers.uv);
    add({"id.object"}, Imf::UINT, layers.object_id);
    add({"id.material"}, Imf::UINT, layers.material_id);
    add({"tests"}, Imf::FLOAT, layers.tests);
  }

  [[nodiscard]] const Imf::FrameBuffer& frame_buffer() const { return frame_buffer_; }

 private:
  static std::vector<half> to_half(const std::vector<float>& values) {
    std::vector<half> result(values.size());
    std::transform(values.begin(), values.end(), result.begin(),
                   [](float value) { return half(std::isnan(value) ? 0.0f : std::clamp(value, -65504.0f, 65504.0f)); });
    return result;
  }

  template <typename T>
  void add(std::initializer_list<const char*> names, Imf::PixelType type, const std::vector<T>& pixels) {
    if (pixels.empty()) return;
    const std::size_t stride = names.size() * sizeof(T);
    char* base = const_cast<char*>(reinterpret_cast<const char*>(pixels.data()));
    for (const char* name : names) {
      header_.channels().insert(name, Imf::Channel(type));
      frame_buffer_.insert(name, Imf::Slice(type, base, stride, stride * width_));
      base += sizeof(T);
    }
  }

  std::size_t width_;
  Imf::Header& header_;
  Imf::FrameBuffer frame_buffer_;
  std::vector<half> rgba_, albedo_;
};

void check_sizes(const FrameLayers& layers) {
  constexpr std::uint32_t max_side = 1u << 20;
  if (layers.width == 0 || layers.height == 0 || layers.width > max_side || layers.height > max_side)
    throw Error(ErrorKind::usage, "EXR: " + std::to_string(layers.width) + "x" + std::to_string(layers.height) +
                                      " is not a size of an image");
  const std::size_t pixels = std::size_t{layers.width} * layers.height;
  const auto check = [&](const char* name, std::size_t values, std::size_t per_pixel) {
    if (values != 0 && values != pixels * per_pixel)
      throw Error(ErrorKind::usage, std::string("EXR: layer ") + name + " has " + std::to_string(values) +
                                        " values, not " + std::to_string(pixels * per_pixel));
  };
  check("RGBA", layers.rgba.size(), 4);
  check("Z", layers.depth.size(), 1);
  check("N", layers.normal.size(), 3);
  check("P", layers.position.size(), 3);
  check("albedo", layers.albedo.size(), 3);
  check("UV", layers.uv.size(), 2);
  check("id.object", layers.object_id.size(), 1);
  check("id.material", layers.material_id.size(), 1);
  check("tests", layers.tests.size(), 1);
}

void check_conflict(const FrameLayers& layers, Compression compression) {
  LayerSet data;
  data.normal = !layers.normal.empty();
  data.position = !layers.position.empty();
  data.uv = !layers.uv.empty();
  const std::string conflict = compression_conflict(compression, data);
  if (!conflict.empty()) throw Error(ErrorKind::usage, conflict);
}

// The magic number, the version (2, a single part of scanlines; no name is long) and the attributes.
void write_header(AtomicStream& stream, const Imf::Header& header) {
  constexpr std::array<std::uint8_t, 8> start{0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0};
  stream.write(reinterpret_cast<const char*>(start.data()), static_cast<int>(start.size()));
  header.writeTo(stream);
}

Imath::M44f to_row_vectors(const glm::dmat4& matrix) {
  Imath::M44f result;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) result[i][j] = static_cast<float>(matrix[i][j]);
  return result;
}

// Non-drop SMPTE time of the frame number at the rounded rate; before 0 and past 24 hours it wraps around, as tape
// does. The frame field ends at 29: above 30 a second frames are counted in pairs, and the field flag says which of the
// two (SMPTE ST 12-1); above 60 there is no time code.
void add_time_code(Imf::Header& header, std::int64_t frame, double fps) {
  const auto rate = std::max<std::int64_t>(1, std::llround(std::min(fps, 1e6)));
  if (rate > 60) return;
  const std::int64_t day = rate * 24 * 60 * 60;
  const std::int64_t wrapped = (frame % day + day) % day;
  const std::int64_t seconds = wrapped / rate, in_second = wrapped % rate;
  const bool pairs = rate > 30;
  Imf::TimeCode code(static_cast<int>(seconds / 3600), static_cast<int>(seconds / 60 % 60),
                     static_cast<int>(seconds % 60), static_cast<int>(pairs ? in_second / 2 : in_second));
  code.setFieldPhase(pairs && in_second % 2 == 1);
  Imf::addTimeCode(header, code);
}

void add_attributes(Imf::Header& header, const FrameAttributes& attributes) {
  if (!std::isfinite(attributes.fps) || attributes.fps <= 0)
    throw Error(ErrorKind::usage, "EXR: frames per second must be a positive number");
  if (std::abs(attributes.frame) > std::numeric_limits<int>::max())
    throw Error(ErrorKind::usage, "EXR: frame " + std::to_string(attributes.frame) + " does not fit an attribute");
  Imf::addChromaticities(header, Imf::Chromaticities({0.64f, 0.33f}, {0.30f, 0.60f}, {0.15f, 0.06f},
                                                     {0.3127f, 0.3290f}));  // ITU-R BT.709, D65
  glm::dmat4 left_handed{1};
  left_handed[2][2] = -1;
  Imf::addWorldToCamera(header, to_row_vectors(left_handed * attributes.world_to_camera));
  Imf::addWorldToNDC(header, to_row_vectors(attributes.world_to_ndc));
  Imf::addFramesPerSecond(header, Imf::guessExactFps(attributes.fps));
  add_time_code(header, attributes.frame, attributes.fps);
  const auto add_text = [&](const char* name, const std::string& text) {
    header.insert(name, Imf::StringAttribute(text));
  };
  add_text("software", "Sheaf " + attributes.version);
  add_text("sheaf:sceneHash", attributes.scene_sha256);
  add_text("sheaf:settings", attributes.settings_json);
  add_text("sheaf:strategy", attributes.strategy);
  header.insert("sheaf:frame", Imf::IntAttribute(static_cast<int>(attributes.frame)));
  header.insert("sheaf:time", Imf::DoubleAttribute(attributes.time_s));
}

}  // namespace

void write_exr(const std::string& path, const FrameLayers& layers, const FrameAttributes& attributes,
               Compression compression) {
  check_sizes(layers);
  check_conflict(layers, compression);
  Imf::Header header(static_cast<int>(layers.width), static_cast<int>(layers.height));
  header.compression() = imf_compressions.at(static_cast<std::size_t>(compression));
  add_attributes(header, attributes);
  const Channels channels(layers, header);
  if (channels.frame_buffer().begin() == channels.frame_buffer().end())
    throw Error(ErrorKind::usage, "EXR: there is no layer to write");

  AtomicFile file(path);
  AtomicStream stream(file, path);
  try {
    if (compression == Compression::zip || compression == Compression::zips) {
      write_header(stream, header);
      write_zip_chunks(file, header, channels.frame_buffer());
      return file.commit();
    }
    constexpr int threads = 0;  // lines are compressed here, in order
    Imf::OutputFile output(stream, header, threads);
    output.setFrameBuffer(channels.frame_buffer());
    output.writePixels(static_cast<int>(layers.height));
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    throw io_error(path, std::string("cannot write: ") + error.what());
  }
  // ~OutputFile writes the chunk table and swallows what fails there; the file remembers it.
  file.commit();
}

}  // namespace sheaf
