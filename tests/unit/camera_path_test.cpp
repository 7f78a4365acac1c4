// SPDX-License-Identifier: MIT
#include "scene/camera_path.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "core/error.hpp"

namespace sheaf {
namespace {

using std::numbers::pi;

CameraPath parse(const std::string& keys, const std::string& more = "") {
  return parse_camera_path("{\"version\":1," + more + "\"keys\":[" + keys + "]}", "path.json");
}

CameraView view_at(const CameraPath& path, double time, double aspect = 1) {
  return evaluate_camera_path(path, time, aspect);
}
glm::dvec3 eye_at(const CameraPath& path, double time) { return glm::dvec3(view_at(path, time).to_world[3]); }
glm::dvec3 looking_at(const CameraPath& path, double time) { return -glm::dvec3(view_at(path, time).to_world[2]); }

std::string at(double time, const std::string& position, const std::string& rotation = "[0,0,0,1]",
               const std::string& more = "") {
  return "{\"time\":" + std::to_string(time) + ",\"position\":" + position + ",\"rotation\":" + rotation + more + "}";
}

void expect_near(const glm::dvec3& a, const glm::dvec3& b, double tolerance = 1e-9) {
  EXPECT_LT(glm::distance(a, b), tolerance)
      << a.x << " " << a.y << " " << a.z << " is not " << b.x << " " << b.y << " " << b.z;
}

TEST(CameraPath, TheThreeWaysToPlaceACameraAgree) {
  // From (3,0,0) towards the origin: -Z becomes -X, so the camera is turned by 90° about Y.
  const double h = std::sqrt(0.5);
  const std::string turned = "[0," + std::to_string(h) + ",0," + std::to_string(h) + "]";
  for (const std::string& key :
       {at(0, "[3,0,0]", turned), std::string(R"({"time":0,"eye":[3,0,0],"target":[0,0,0],"up":[0,1,0]})"),
        std::string(R"({"time":0,"matrix":[0,0,-2,0, 0,2,0,0, 2,0,0,0, 3,0,0,1]})")}) {
    const CameraView view = view_at(parse(key), 0);
    expect_near(glm::dvec3(view.to_world[3]), {3, 0, 0});
    expect_near(-glm::dvec3(view.to_world[2]), {-1, 0, 0}, 1e-6);
    expect_near(glm::dvec3(view.to_world[1]), {0, 1, 0}, 1e-6);
    expect_near(glm::dvec3(view.to_world[0]), {0, 0, -1}, 1e-6);
  }
}

TEST(CameraPath, LinearStepAndClamping) {
  const std::string keys = at(1, "[0,0,0]") + "," + at(3, "[4,0,0]", "[0,1,0,0]");
  const CameraPath linear = parse(keys);
  expect_near(eye_at(linear, 1.5), {1, 0, 0});
  expect_near(eye_at(linear, 0), {0, 0, 0});
  expect_near(eye_at(linear, 9), {4, 0, 0});
  EXPECT_NEAR(std::abs(looking_at(linear, 2).x), 1, 1e-9);  // half of half a turn
  expect_near(eye_at(parse(keys, R"("interpolation":"step",)"), 2.99), {0, 0, 0});
}

TEST(CameraPath, CatmullRomKeepsStraightMotionAndPassesThroughKeys) {
  // Uneven times, even speed: a spline that heeds the times gives exactly that motion back.
  const std::string mode = R"("interpolation":"catmull-rom",)";
  const CameraPath straight =
      parse(at(0, "[0,0,0]") + "," + at(1, "[2,0,0]") + "," + at(4, "[8,0,0]") + "," + at(5, "[10,0,0]"), mode);
  for (const double time : {0.3, 1.0, 2.5, 3.9, 4.7}) expect_near(eye_at(straight, time), {2 * time, 0, 0});
  // Parabola y = x² sampled at unit times: Catmull-Rom gives it back between inner keys.
  const CameraPath bent =
      parse(at(0, "[0,0,0]") + "," + at(1, "[1,1,0]") + "," + at(2, "[2,4,0]") + "," + at(3, "[3,9,0]"), mode);
  expect_near(eye_at(bent, 1.5), {1.5, 2.25, 0});
  expect_near(eye_at(bent, 2), {2, 4, 0});
}

TEST(CameraPath, CatmullRomTurnsSmoothly) {
  const auto about_y = [](double angle) {
    return "[0," + std::to_string(std::sin(angle / 2)) + ",0," + std::to_string(std::cos(angle / 2)) + "]";
  };
  const CameraPath path = parse(at(0, "[0,0,0]", about_y(0)) + "," + at(1, "[0,0,0]", about_y(0.5)) + "," +
                                    at(3, "[0,0,0]", about_y(1.5)) + "," + at(4, "[0,0,0]", about_y(2.5)),
                                R"("interpolation":"catmull-rom",)");
  // Even speed of 0.5 rad/s up to the third key is kept between the first two inner keys' chords.
  expect_near(looking_at(path, 0.5), {-std::sin(0.25), 0, -std::cos(0.25)}, 1e-5);
  const double step = 1e-4;  // no corner at the third key, where the chords' speeds differ by a factor of two
  const glm::dvec3 before = (looking_at(path, 3) - looking_at(path, 3 - step)) / step;
  const glm::dvec3 after = (looking_at(path, 3 + step) - looking_at(path, 3)) / step;
  expect_near(before, after, 1e-3);
}

TEST(CameraPath, LoopsWrapTime) {
  const CameraPath path = parse(at(1, "[0,0,0]") + "," + at(2, "[1,0,0]") + "," + at(3, "[0,0,0]"), R"("loop":true,)");
  expect_near(eye_at(path, 1.5 + 2 * 7), eye_at(path, 1.5));
  expect_near(eye_at(path, 1.5 - 2 * 3), {0.5, 0, 0});
}

TEST(CameraPath, AClosedLoopHasNoCornerAtItsSeam) {
  const CameraPath path = parse(at(0, "[0,0,0]") + "," + at(1, "[1,0,0]") + "," + at(2, "[1,1,0]") + "," +
                                    at(3, "[0,1,0]") + "," + at(4, "[0,0,0]"),
                                R"("interpolation":"catmull-rom","loop":true,)");
  const double step = 1e-5;
  const glm::dvec3 before = (eye_at(path, 4 - step) - eye_at(path, 4 - 2 * step)) / step;
  const glm::dvec3 after = (eye_at(path, 4 + 2 * step) - eye_at(path, 4 + step)) / step;
  expect_near(before, after, 1e-3);
  expect_near(after, {0.5, -0.5, 0}, 1e-3);  // half of the way from (0,1) to (1,0)
}

TEST(CameraPath, Lenses) {
  const double forty = 40 * pi / 180;
  EXPECT_NEAR(view_at(parse(at(0, "[0,0,0]", "[0,0,0,1]", R"(,"fov_degrees":40)")), 0, 2).tan_half_y,
              std::tan(forty / 2), 1e-12);
  const CameraPath wide =
      parse(at(0, "[0,0,0]", "[0,0,0,1]", R"(,"fov_degrees":40,"near":1,"far":9)"), R"("fov_axis":"horizontal",)");
  EXPECT_NEAR(view_at(wide, 0, 2).tan_half_y, std::tan(forty / 2) / 2, 1e-12);
  EXPECT_EQ(view_at(wide, 0).near, 1);
  EXPECT_EQ(view_at(wide, 0).far, 9);
  const std::string film = R"(,"focal_mm":35,"sensor_mm":[36,24])";
  EXPECT_NEAR(view_at(parse(at(0, "[0,0,0]", "[0,0,0,1]", film)), 0).tan_half_y, 12.0 / 35, 1e-12);
  EXPECT_NEAR(view_at(parse(at(0, "[0,0,0]", "[0,0,0,1]", film), R"("fov_axis":"horizontal",)"), 0, 1.5).tan_half_y,
              12.0 / 35, 1e-12);
  // Linear in angle; between perspective and orthographic the earlier key's lens holds.
  const CameraPath zoom = parse(at(0, "[0,0,0]", "[0,0,0,1]", R"(,"fov_degrees":20)") + "," +
                                at(1, "[0,0,0]", "[0,0,0,1]", R"(,"fov_degrees":60)") + "," +
                                at(2, "[2,0,0]", "[0,0,0,1]", R"(,"ortho_height":4)"));
  EXPECT_NEAR(view_at(zoom, 0.5).tan_half_y, std::tan(forty / 2), 1e-12);
  EXPECT_FALSE(view_at(zoom, 1.9).orthographic);
  EXPECT_TRUE(view_at(zoom, 2).orthographic);
  EXPECT_EQ(view_at(zoom, 2).half_height, 2);
}

TEST(CameraPath, FramesASecond) {
  EXPECT_EQ(parse(at(0, "[0,0,0]"), R"("fps":25,)").fps, 25.0);
  EXPECT_NEAR(*parse(at(0, "[0,0,0]"), R"("fps":"24000/1001",)").fps, 23.976023976, 1e-9);
  EXPECT_FALSE(parse(at(0, "[0,0,0]")).fps.has_value());
}

struct Wrong {
  const char* text;
  const char* expected;
};

TEST(CameraPath, WrongFilesAreRefusedByPlace) {
  const Wrong wrong[] = {
      {"[]", "path.json: must be an object"},
      {"{", "is not valid JSON"},
      {R"({"version":2,"keys":[]})", "version: only version 1"},
      {R"({"keys":[]})", "keys: must be a list with at least one"},
      {R"({"fps":24})", "keys: is missing"},
      {R"({"speed":1,"keys":[]})", "unknown key \"speed\""},
      {R"({"fps":0,"keys":[]})", "fps: must be a positive number"},
      {R"({"fps":"24/0","keys":[]})", "fps: must be a positive number"},
      {R"({"fps":"24fps","keys":[]})", "fps: must be a positive number"},
      {R"({"interpolation":"cubic","keys":[]})", "interpolation: \"cubic\" is not one of"},
      {R"({"loop":1,"keys":[]})", "loop: must be true or false"},
      {R"({"fov_axis":"diagonal","keys":[]})", "fov_axis: \"diagonal\""},
      {R"({"keys":[3]})", "keys[0]: must be an object"},
      {R"({"keys":[{"time":0,"roll":1,"position":[0,0,0],"rotation":[0,0,0,1]}]})", "keys[0]: unknown key \"roll\""},
      {R"({"keys":[{"position":[0,0,0],"rotation":[0,0,0,1]}]})", "keys[0].time: is missing"},
      {R"({"keys":[{"time":"0","position":[0,0,0],"rotation":[0,0,0,1]}]})", "keys[0].time: must be a number"},
      {R"({"keys":[{"time":1e999,"position":[0,0,0],"rotation":[0,0,0,1]}]})", "is not valid JSON"},
      {R"({"keys":[{"time":NaN,"position":[0,0,0],"rotation":[0,0,0,1]}]})", "is not valid JSON"},
      {R"({"keys":[{"time":0}]})", "keys[0]: needs one of"},
      {R"({"keys":[{"time":0,"position":[0,0,0],"rotation":[0,0,0,1],"eye":[0,0,0]}]})", "keys[0]: needs one of"},
      {R"({"keys":[{"time":0,"position":[0,0],"rotation":[0,0,0,1]}]})", "keys[0].position: must be a list of 3"},
      {R"({"keys":[{"time":0,"position":[0,0,0]}]})", "keys[0].rotation: is missing"},
      {R"({"keys":[{"time":0,"position":[0,0,0],"rotation":[0,0,0,0]}]})", "keys[0].rotation: has no length"},
      {R"({"keys":[{"time":0,"eye":[1,1,1],"target":[1,1,1]}]})", "keys[0].target: is at the eye"},
      {R"({"keys":[{"time":0,"eye":[0,0,0],"target":[0,5,0],"up":[0,1,0]}]})", "keys[0].up: is parallel to the view"},
      {R"({"keys":[{"time":0,"eye":[0,0,0],"target":[0,0,1],"up":[0,0,0]}]})", "keys[0].up: has no length"},
      {R"({"keys":[{"time":0,"matrix":[1,0,0,0,0,1,0,0,0,0,0,0,0,0,0,1]}]})", "keys[0].matrix: is singular"},
      {R"({"keys":[{"time":0,"matrix":[-1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}]})", "keys[0].matrix: is a reflection"},
      {R"({"keys":[{"time":0,"matrix":[1,0,0,5,0,1,0,0,0,0,1,0,0,0,0,1]}]})", "keys[0].matrix: has a last row"},
      {R"({"keys":[{"time":0,"position":[0,0,0],"rotation":[0,0,0,1],"fov_degrees":180}]})",
       "keys[0].fov_degrees: must be between"},
      {R"({"keys":[{"time":0,"position":[0,0,0],"rotation":[0,0,0,1],"fov_degrees":9,"focal_mm":9}]})",
       "more than one of"},
      {R"({"keys":[{"time":0,"position":[0,0,0],"rotation":[0,0,0,1],"sensor_mm":[1,1]}]})",
       "keys[0].focal_mm: is missing"},
      {R"({"keys":[{"time":0,"position":[0,0,0],"rotation":[0,0,0,1],"ortho_height":0}]})",
       "keys[0].ortho_height: must be larger"},
      {R"({"keys":[{"time":0,"position":[0,0,0],"rotation":[0,0,0,1],"near":-1}]})",
       "keys[0].near: must not be negative"},
      {R"({"keys":[{"time":0,"position":[0,0,0],"rotation":[0,0,0,1],"near":2,"far":1}]})",
       "keys[0].far: must be larger"},
      {R"({"keys":[{"time":1,"position":[0,0,0],"rotation":[0,0,0,1]},{"time":1,"position":[0,0,0],"rotation":[0,0,0,1]}]})",
       "keys[1].time: is not later"},
      {R"({"camera_path":[]})", "camera_path: must be a list with at least one"},
      {R"({"camera_type":"equirectangular","camera_path":[]})", "camera_type: \"equirectangular\" is not supported"},
      {R"({"camera_path":[{"fov":50}]})", "camera_path[0].camera_to_world: is missing"},
  };
  for (const Wrong& w : wrong) {
    try {
      (void)parse_camera_path(w.text, "path.json");
      ADD_FAILURE() << "was read: " << w.text;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      EXPECT_NE(std::string(error.what()).find(w.expected), std::string::npos) << error.what() << " for " << w.text;
    }
  }
}

// What lies between two keys may be far outside what numbers hold, however finite the keys are.
TEST(CameraPath, MotionBeyondNumbersIsRefused) {
  const auto key = [](const char* time, const char* z) {
    return "{\"time\":" + std::string(time) + ",\"position\":[0,0," + z + "],\"rotation\":[0,0,0,1]}";
  };
  const auto refused = [](const char* more, const std::string& keys, const char* place) {
    try {
      (void)parse(keys, more);
      ADD_FAILURE() << "was read: " << keys;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      EXPECT_NE(std::string(error.what()).find(place), std::string::npos) << error.what() << " for " << keys;
    }
  };
  const char *const smooth = R"("interpolation":"catmull-rom",)", *const stepped = R"("interpolation":"step",)";
  const std::string far_apart = key("0", "1e308") + "," + key("1", "-1e308");
  const std::string sudden = key("0", "0") + "," + key("1e-300", "1") + "," + key("1e10", "2") + "," + key("2e10", "3");
  refused("", far_apart, "keys[0]: the camera moves too far or too fast");
  refused(smooth, sudden, "keys[1]: the camera moves too far or too fast");
  refused("", key("-1e308", "0") + "," + key("1e308", "0"), "keys[0]: ");
  refused("", key("-1e308", "0") + "," + key("0", "0") + "," + key("1e308", "0"), "keys[0]: ");
  EXPECT_EQ(parse(far_apart, stepped).keys.size(), 2u);
  EXPECT_EQ(parse(sudden).keys.size(), 4u);
}

TEST(CameraPath, Nerfstudio) {
  const std::string text =
      R"({"keyframes":[],"camera_type":"perspective","render_height":540,"render_width":960,"fps":4,"seconds":0.5,
    "smoothness_value":0.5,"is_cycle":false,"crop":null,"camera_path":[
    {"camera_to_world":[1,0,0,10, 0,0,-1,20, 0,1,0,30, 0,0,0,1],"fov":50,"aspect":1.7},
    {"camera_to_world":[1,0,0,12, 0,0,-1,20, 0,1,0,30, 0,0,0,1],"fov":50,"aspect":1.7}]})";
  const CameraPath path = parse_camera_path(text, "camera_path.json");
  EXPECT_EQ(path.fps, 4.0);
  ASSERT_EQ(path.keys.size(), 2u);
  EXPECT_EQ(path.keys[1].time, 0.25);
  expect_near(eye_at(path, 0.125), {11, 20, 30});
  expect_near(looking_at(path, 0), {0, 1, 0});  // the third column is (0, -1, 0)
  EXPECT_NEAR(view_at(path, 0, 1.7).tan_half_y, std::tan(25 * pi / 180), 1e-12);
}

TEST(CameraPath, MissingFileIsAnIoError) {
  try {
    (void)load_camera_path("/nonexistent/path.json");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::io);
  }
}

}  // namespace
}  // namespace sheaf
