// SPDX-License-Identifier: MIT
// What a frame's file says of it beside its pixels.
#include <ImfDoubleAttribute.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfIntAttribute.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>

#include <glm/gtc/matrix_transform.hpp>

#include "exr_support.hpp"

namespace sheaf {
namespace {

using test::attributes;
using test::tiny;

class ExrAttributesTest : public test::OutputTest {
 protected:
  template <typename Attribute>
  [[nodiscard]] auto attribute(const char* name) const {
    return Imf::InputFile(path("a.exr").c_str(), 0).header().typedAttribute<Attribute>(name).value();
  }
  [[nodiscard]] Imf::TimeCode time_code(std::int64_t frame, double fps) const {
    FrameAttributes with = attributes();
    with.frame = frame;
    with.fps = fps;
    write_exr(path("a.exr"), tiny(), with, Compression::zip);
    return Imf::timeCode(Imf::InputFile(path("a.exr").c_str(), 0).header());
  }
};

TEST_F(ExrAttributesTest, AttributesSayWhatTheFrameIs) {
  write_exr(path("a.exr"), tiny(), attributes(), Compression::zip);
  EXPECT_EQ(attribute<Imf::StringAttribute>("software"), "Sheaf 0.1.0");
  EXPECT_EQ(attribute<Imf::StringAttribute>("sheaf:sceneHash"), "abc123");
  EXPECT_EQ(attribute<Imf::StringAttribute>("sheaf:settings"), R"({"size":[37,53]})");
  EXPECT_EQ(attribute<Imf::StringAttribute>("sheaf:strategy"), "hybrid");
  EXPECT_EQ(attribute<Imf::IntAttribute>("sheaf:frame"), 12);
  EXPECT_EQ(attribute<Imf::DoubleAttribute>("sheaf:time"), 0.5);
  const Imf::Chromaticities rec709 = attribute<Imf::ChromaticitiesAttribute>("chromaticities");
  EXPECT_EQ(rec709.red, Imath::V2f(0.64f, 0.33f));
  EXPECT_EQ(rec709.green, Imath::V2f(0.30f, 0.60f));
  EXPECT_EQ(rec709.blue, Imath::V2f(0.15f, 0.06f));
  EXPECT_EQ(rec709.white, Imath::V2f(0.3127f, 0.3290f));
}

TEST_F(ExrAttributesTest, MatricesFollowOpenExrsConventions) {
  // A camera at (1, 2, 3) looking along -Z, 90 degrees, square.
  FrameAttributes with = attributes();
  with.world_to_camera = glm::translate(glm::dmat4(1), {-1, -2, -3});
  glm::dmat4 to_ndc(0);  // x' = (x - z) / 2, y' = (-y - z) / 2, w' = -z: the middle of the image is (0.5, 0.5)
  to_ndc[0][0] = 0.5;
  to_ndc[1][1] = -0.5;
  to_ndc[2] = {-0.5, -0.5, 0, -1};
  with.world_to_ndc = to_ndc * with.world_to_camera;
  write_exr(path("a.exr"), tiny(), with, Compression::zip);
  const Imath::M44f to_camera = attribute<Imf::M44fAttribute>("worldToCamera");
  EXPECT_EQ(Imath::V3f(1, 2, 3) * to_camera, Imath::V3f(0, 0, 0));
  EXPECT_EQ(Imath::V3f(2, 4, -7) * to_camera, Imath::V3f(1, 2, 10)) << "right, up, and 10 ahead as +Z";
  const Imath::M44f ndc = attribute<Imf::M44fAttribute>("worldToNDC");
  const Imath::V3f centre = Imath::V3f(1, 2, -7) * ndc, corner = Imath::V3f(-9, 12, -7) * ndc;
  EXPECT_EQ(Imath::V2f(centre.x, centre.y), Imath::V2f(0.5f, 0.5f));
  EXPECT_EQ(Imath::V2f(corner.x, corner.y), Imath::V2f(0, 0)) << "left and up is the upper left corner";
}

TEST_F(ExrAttributesTest, FramesPerSecondIsExact) {
  const auto rate = [&](double fps) {
    (void)time_code(1, fps);
    return attribute<Imf::RationalAttribute>("framesPerSecond");
  };
  EXPECT_EQ(rate(24).n, 24);
  EXPECT_EQ(rate(24).d, 1u);
  EXPECT_EQ(rate(24000 / 1001.0).n, 24000);
  EXPECT_EQ(rate(24000 / 1001.0).d, 1001u);
  EXPECT_EQ(rate(12.5).n, 25);
  EXPECT_EQ(rate(12.5).d, 2u);
}

TEST_F(ExrAttributesTest, TimeCodes) {
  const auto text = [](const Imf::TimeCode& code) {
    return std::to_string(code.hours()) + ":" + std::to_string(code.minutes()) + ":" + std::to_string(code.seconds()) +
           ":" + std::to_string(code.frame()) + (code.fieldPhase() ? "b" : "") + (code.dropFrame() ? "d" : "");
  };
  EXPECT_EQ(text(time_code(0, 24)), "0:0:0:0");
  EXPECT_EQ(text(time_code(24 * 3661 + 23, 24)), "1:1:1:23");
  EXPECT_EQ(text(time_code(24, 24000 / 1001.0)), "0:0:1:0") << "counts frames, drops none";
  EXPECT_EQ(text(time_code(-1, 24)), "23:59:59:23");
  EXPECT_EQ(text(time_code(24 * 86400, 24)), "0:0:0:0");
  EXPECT_EQ(text(time_code(29, 30)), "0:0:0:29");
  EXPECT_EQ(text(time_code(47, 48)), "0:0:0:23b");
  EXPECT_EQ(text(time_code(59, 60)), "0:0:0:29b");
  EXPECT_EQ(text(time_code(48, 60)), "0:0:0:24");
  EXPECT_EQ(text(time_code(5, 0.25)), "0:0:5:0");
  FrameAttributes fast = attributes();
  fast.fps = 120;
  write_exr(path("a.exr"), tiny(), fast, Compression::zip);
  EXPECT_FALSE(Imf::hasTimeCode(Imf::InputFile(path("a.exr").c_str(), 0).header()));
}

}  // namespace
}  // namespace sheaf
