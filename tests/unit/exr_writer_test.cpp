// SPDX-License-Identifier: MIT
#include "output/exr_writer.hpp"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfMultiPartInputFile.h>
#include <ImfOutputFile.h>
#include <sys/resource.h>

#include <array>
#include <cmath>
#include <csignal>
#include <cstring>
#include <limits>
#include <map>

#include "core/choice.hpp"
#include "exr_support.hpp"

namespace sheaf {
namespace {

using test::attributes;
using test::contents;
using test::error_of;
using test::full;
using test::tiny;

constexpr float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
constexpr std::array lossless{Compression::none, Compression::rle, Compression::zips, Compression::zip,
                              Compression::piz};

template <typename T>
std::vector<T> channel(const std::string& path, const char* name, Imf::PixelType type) {
  Imf::InputFile file(path.c_str(), 0);
  const Imf::Channel* found = file.header().channels().findChannel(name);
  EXPECT_TRUE(found != nullptr && found->type == type) << name;
  const Imath::Box2i window = file.header().dataWindow();
  const auto width = static_cast<std::size_t>(window.max.x + 1), height = static_cast<std::size_t>(window.max.y + 1);
  std::vector<T> values(width * height);
  Imf::FrameBuffer buffer;
  buffer.insert(name, Imf::Slice(type, reinterpret_cast<char*>(values.data()), sizeof(T), sizeof(T) * width));
  file.setFrameBuffer(buffer);
  file.readPixels(0, static_cast<int>(height) - 1);
  return values;
}

template <typename T>
void expect_same(const std::string& path, std::vector<const char*> names, Imf::PixelType type,
                 const std::vector<T>& interleaved) {
  for (std::size_t c = 0; c < names.size(); ++c) {
    const std::vector<T> read = channel<T>(path, names[c], type);
    std::vector<T> wanted;
    for (std::size_t i = c; i < interleaved.size(); i += names.size()) wanted.push_back(interleaved[i]);
    EXPECT_TRUE(read == wanted) << names[c];
  }
}

std::vector<half> halves(const std::vector<float>& values) { return {values.begin(), values.end()}; }

class ExrWriterTest : public test::OutputTest {};

TEST_F(ExrWriterTest, EveryLayerReadsBackExactly) {
  const FrameLayers layers = full();
  for (const Compression compression : lossless) {
    SCOPED_TRACE(name_of(compression));
    const std::string file = path("a.exr");
    write_exr(file, layers, attributes(), compression);
    expect_same(file, {"R", "G", "B", "A"}, Imf::HALF, halves(layers.rgba));
    expect_same(file, {"Z"}, Imf::FLOAT, layers.depth);
    expect_same(file, {"N.X", "N.Y", "N.Z"}, Imf::FLOAT, layers.normal);
    expect_same(file, {"P.X", "P.Y", "P.Z"}, Imf::FLOAT, layers.position);
    expect_same(file, {"albedo.R", "albedo.G", "albedo.B"}, Imf::HALF, halves(layers.albedo));
    expect_same(file, {"UV.X", "UV.Y"}, Imf::FLOAT, layers.uv);
    expect_same(file, {"id.object"}, Imf::UINT, layers.object_id);
    expect_same(file, {"id.material"}, Imf::UINT, layers.material_id);
    expect_same(file, {"tests"}, Imf::FLOAT, layers.tests);
    EXPECT_TRUE(exr_is_whole(file, 37, 53));
  }
}

// What OpenEXR itself writes of the same header and pixels: the same bytes up to the chunks, and as many of these.
TEST_F(ExrWriterTest, ZipFilesAreLaidOutAsOpenExrDoes) {
  for (const Compression compression : {Compression::zips, Compression::zip})
    for (const std::uint32_t height : {1U, 15U, 16U, 17U, 53U}) {
      SCOPED_TRACE(name_of(compression) + std::string(", lines: ") + std::to_string(height));
      write_exr(path("a.exr"), full(37, height), attributes(), compression);
      Imf::InputFile ours(path("a.exr").c_str(), 0);
      Imf::Header header = ours.header();
      header.erase("type");  // filled in by the reader
      std::uint64_t table = 0;
      {
        const std::vector<char> lines(std::size_t{37} * height * 4);
        Imf::FrameBuffer buffer;
        const Imf::ChannelList& channels = header.channels();
        for (auto at = channels.begin(); at != channels.end(); ++at)
          buffer.insert(at.name(), Imf::Slice(at.channel().type, const_cast<char*>(lines.data()), 4, 37 * 4));
        Imf::OutputFile theirs(path("b.exr").c_str(), header, 0);
        theirs.setFrameBuffer(buffer);
        theirs.writePixels(static_cast<int>(height));
      }
      const std::string a = contents(path("a.exr")), b = contents(path("b.exr"));
      const std::size_t lines = compression == Compression::zip ? 16 : 1, chunks = (height + lines - 1) / lines;
      const auto place = [](const std::string& file, std::size_t at) {
        std::uint64_t value = 0;
        std::memcpy(&value, file.data() + at, sizeof value);
        return value;
      };
      for (table = 8; table + 8 < a.size() && place(a, table) != table + chunks * 8; ++table) {
      }
      EXPECT_EQ(a.substr(0, table), b.substr(0, table));
      EXPECT_EQ(place(b, table), table + chunks * 8);
      std::uint64_t next = table + chunks * 8;
      for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
        ASSERT_EQ(place(a, table + chunk * 8), next);
        EXPECT_EQ(a.substr(next, 4), b.substr(place(b, table + chunk * 8), 4));  // its first line
        std::int32_t size = 0;
        std::memcpy(&size, a.data() + next + 4, sizeof size);
        next += 8 + static_cast<std::uint64_t>(size);
      }
      EXPECT_EQ(next, a.size());
    }
}

TEST_F(ExrWriterTest, WhatDoesNotBecomeSmallerIsStoredAsItIs) {
  FrameLayers layers{64, 40, {}, {}, {}, {}, {}, {}, {}, {}, {}};
  std::mt19937 random(1);
  for (int i = 0; i < 64 * 40; ++i) layers.object_id.push_back(static_cast<std::uint32_t>(random()));
  for (const Compression compression : {Compression::zips, Compression::zip}) {
    write_exr(path("a.exr"), layers, attributes(), compression);
    expect_same(path("a.exr"), {"id.object"}, Imf::UINT, layers.object_id);
    EXPECT_NE(contents(path("a.exr"))
                  .find(std::string(reinterpret_cast<const char*>(layers.object_id.data()), std::size_t{64} * 4)),
              std::string::npos);
  }
}

TEST_F(ExrWriterTest, RowZeroIsAtTheTop) {
  FrameLayers layers;
  layers.width = 2;
  layers.height = 3;
  layers.depth = {1, 2, 3, 4, 5, 6};
  write_exr(path("a.exr"), layers, attributes(), Compression::none);
  EXPECT_EQ(Imf::InputFile(path("a.exr").c_str(), 0).header().lineOrder(), Imf::INCREASING_Y);
  EXPECT_EQ(channel<float>(path("a.exr"), "Z", Imf::FLOAT), layers.depth);
}

TEST_F(ExrWriterTest, OnlyWhatWasGivenIsThere) {
  write_exr(path("a.exr"), tiny(), attributes(), Compression::zip);
  Imf::MultiPartInputFile file(path("a.exr").c_str(), 0);
  EXPECT_EQ(file.parts(), 1);
  std::vector<std::string> channels;
  const auto& list = file.header(0).channels();
  for (auto at = list.begin(); at != list.end(); ++at) channels.emplace_back(at.name());
  EXPECT_EQ(channels, (std::vector<std::string>{"A", "B", "G", "R"}));
  EXPECT_FALSE(file.header(0).hasTileDescription());
  EXPECT_EQ(file.header(0).compression(), Imf::ZIP_COMPRESSION);
  std::vector<std::string> attribute_names;
  for (auto at = file.header(0).begin(); at != file.header(0).end(); ++at)
    if (at.name() != std::string("type")) attribute_names.emplace_back(at.name());  // filled in by the reader
  EXPECT_EQ(
      attribute_names,
      (std::vector<std::string>{
          "channels", "chromaticities", "compression", "dataWindow", "displayWindow", "framesPerSecond", "lineOrder",
          "pixelAspectRatio", "screenWindowCenter", "screenWindowWidth", "sheaf:frame", "sheaf:sceneHash",
          "sheaf:settings", "sheaf:strategy", "sheaf:time", "software", "timeCode", "worldToCamera", "worldToNDC"}));
}

TEST_F(ExrWriterTest, HalvesAreClampedAndNeverNan) {
  FrameLayers layers = tiny();
  layers.rgba = {1e9f, -1e9f, nan, inf};
  layers.albedo = {-inf, 65519, 1e-9f};
  write_exr(path("a.exr"), layers, attributes(), Compression::zip);
  const auto value = [&](const char* name) {
    return static_cast<float>(channel<half>(path("a.exr"), name, Imf::HALF)[0]);
  };
  EXPECT_EQ(value("R"), 65504);
  EXPECT_EQ(value("G"), -65504);
  EXPECT_EQ(value("B"), 0);
  EXPECT_EQ(value("A"), 65504);
  EXPECT_EQ(value("albedo.R"), -65504);
  EXPECT_EQ(value("albedo.G"), 65504);
  EXPECT_EQ(value("albedo.B"), 0);
}

TEST_F(ExrWriterTest, SameInputSameBytes) {
  for (const Compression compression : lossless) {
    write_exr(path("a.exr"), full(), attributes(), compression);
    write_exr(path("b.exr"), full(), attributes(), compression);
    EXPECT_EQ(contents(path("a.exr")), contents(path("b.exr")));
  }
}

TEST_F(ExrWriterTest, DwaaKeepsDataAndRefusesWhatItWouldHarm) {
  FrameLayers layers = full();
  const auto refusal = [&] {
    return error_of(ErrorKind::usage, [&] { write_exr(path("a.exr"), layers, attributes(), Compression::dwaa); });
  };
  const std::string reason = "of --aov N with loss, as if it were luminance; use zip or piz";
  EXPECT_EQ(refusal(), "--compression dwaa: would store N.Y " + reason);
  layers.normal.clear();
  EXPECT_NE(refusal().find("P.Y"), std::string::npos);
  layers.position.clear();
  EXPECT_NE(refusal().find("UV.Y"), std::string::npos);
  layers.uv.clear();
  EXPECT_EQ(names(), std::vector<std::string>{});
  write_exr(path("a.exr"), layers, attributes(), Compression::dwaa);
  expect_same(path("a.exr"), {"Z"}, Imf::FLOAT, layers.depth);
  expect_same(path("a.exr"), {"id.object"}, Imf::UINT, layers.object_id);
  expect_same(path("a.exr"), {"tests"}, Imf::FLOAT, layers.tests);
  EXPECT_TRUE(exr_is_whole(path("a.exr"), 37, 53));
  EXPECT_EQ(compression_conflict(Compression::dwaa, parse_layers("Z,albedo,id,tests")), "");
  EXPECT_EQ(compression_conflict(Compression::piz, parse_layers("N,P")), "");
}

TEST_F(ExrWriterTest, RefusesWhatDoesNotFit) {
  FrameLayers layers = tiny();
  const auto refusal = [&](const FrameAttributes& with) {
    return error_of(ErrorKind::usage, [&] { write_exr(path("a.exr"), layers, with, Compression::zip); });
  };
  FrameAttributes with = attributes();
  with.fps = 0;
  EXPECT_EQ(refusal(with), "EXR: frames per second must be a positive number");
  with = attributes();
  with.frame = 1ll << 40;
  EXPECT_EQ(refusal(with), "EXR: frame 1099511627776 does not fit an attribute");
  layers.normal = {1, 2};
  EXPECT_EQ(refusal(attributes()), "EXR: layer N has 2 values, not 3");
  layers.normal.clear();
  layers.rgba.clear();
  EXPECT_EQ(refusal(attributes()), "EXR: there is no layer to write");
  layers.height = 0;
  EXPECT_EQ(refusal(attributes()), "EXR: 1x0 is not a size of an image");
  EXPECT_EQ(names(), std::vector<std::string>{});
}

TEST_F(ExrWriterTest, FailuresNameTheFileAndLeaveNothing) {
  EXPECT_EQ(error_of(ErrorKind::io, [&] { write_exr(path("no/a.exr"), tiny(), attributes(), Compression::zip); }),
            path("no/a.exr") + ": cannot create: No such file or directory");
  // A disk that fills up: at any point of the file, down to the chunk table that OpenEXR writes while closing.
  write_exr(path("a.exr"), full(), attributes(), Compression::none);
  const auto size = static_cast<rlim_t>(std::filesystem::file_size(path("a.exr")));
  std::filesystem::remove(path("a.exr"));
  for (const rlim_t room : {rlim_t{0}, rlim_t{100}, size / 2, size - 1}) {
    const int status = test::status_in_child([&] {
      signal(SIGXFSZ, SIG_IGN);
      const rlimit limit{room, room};
      setrlimit(RLIMIT_FSIZE, &limit);
      const std::string text =
          error_of(ErrorKind::io, [&] { write_exr(path("a.exr"), full(), attributes(), Compression::none); });
      _exit(text == path("a.exr") + ": cannot write: File too large" ? 0 : 1);
    });
    EXPECT_EQ(status, 0) << room;
    EXPECT_EQ(names(), std::vector<std::string>{});
  }
}

}  // namespace
}  // namespace sheaf
