// SPDX-License-Identifier: MIT
// The table of settings: that it is sound, and that what follows from an entry follows: reading, checks, presets, JSON.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "core/error.hpp"
#include "settings/setting.hpp"
#include "settings/setting_json.hpp"

namespace sheaf {
namespace {

using nlohmann::json;

RenderOptions read(const std::vector<std::pair<const char*, const char*>>& texts) {
  std::vector<Given> given;
  for (const auto& [name, text] : texts) given.push_back({find_setting(name), text});
  RenderOptions options;
  read_settings(given, options);
  return options;
}

std::string refusal(const char* name, const char* text, ErrorKind kind) {
  try {
    (void)read({{name, text}});
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), kind) << error.what();
    return error.what();
  }
  return "accepted";
}

TEST(SettingsTable, IsSound) {
  std::set<std::string> names;
  for (const Setting& setting : settings_table()) {
    EXPECT_TRUE(names.insert(setting.name).second) << setting.name << " stands twice";
    EXPECT_STRNE(setting.help, "") << setting.name;
    EXPECT_FALSE(setting.http && setting.part != nullptr) << setting.name;
    EXPECT_EQ(find_setting(setting.name), &setting);
    const RenderOptions defaults;
    EXPECT_EQ(setting.required || setting.access.show(defaults).is_null()
                  ? ""
                  : setting.access.outside(defaults, setting.range),
              "")
        << setting.name << "'s default is out of its range";
    const JsonForm& form = setting.kind().json;
    EXPECT_TRUE(!setting.http || form.scalar != nullptr || form.text || form.items != nullptr) << setting.name;
  }
  for (const Preset& preset : presets())
    for (const PresetValue& value : preset.values) {
      ASSERT_NE(find_setting(value.setting), nullptr) << preset.name;
      EXPECT_NO_THROW((void)read({{value.setting, value.text}})) << preset.name;
    }
  EXPECT_EQ(find_setting("colour"), nullptr);
}

TEST(Settings, DefaultsAreThoseOfTheContract) {
  const RenderOptions options = read({});
  EXPECT_EQ(settings_json(options).dump(),
            R"({"size":"1280x720","spp":1,"filter":"gaussian","depth":4,"cutoff":0.002,"glass-alpha":"opaque",)"
            R"("back-faces":"hide","opaque":false,"z-background":10000000000.0,"primary":"auto"})");
  EXPECT_EQ(options.compression, Compression::zip);
  EXPECT_FALSE(options.settings.counted);
}

TEST(Settings, EachTypeIsRead) {
  const RenderOptions options = read({{"size", "640x360"},
                                      {"fps", "24000/1001"},
                                      {"spp", "adaptive:0.02:64"},
                                      {"cutoff", "0.01"},
                                      {"environment", "0.5, 1,+2"},
                                      {"aov", "Z,tests"},
                                      {"z-background", "-inf"},
                                      {"strategy", "classify"},
                                      {"opaque", "true"},
                                      {"camera-node", "Eye"}});
  EXPECT_EQ(options.settings.width, 640U);
  EXPECT_EQ(options.settings.height, 360U);
  EXPECT_DOUBLE_EQ(options.fps.value(), 24000.0 / 1001);
  EXPECT_EQ(options.settings.samples.most, 64U);
  EXPECT_DOUBLE_EQ(options.settings.samples.error.value(), 0.02);
  EXPECT_EQ(options.settings.environment, glm::vec3(0.5F, 1, 2));
  EXPECT_TRUE(options.settings.layers.depth && options.settings.layers.tests && !options.settings.layers.normal);
  EXPECT_TRUE(options.settings.counted) << "the layer tests needs them counted";
  EXPECT_EQ(options.settings.z_background, -INFINITY);
  EXPECT_EQ(options.settings.strategy, Strategy::classify);
  EXPECT_TRUE(options.settings.opaque);
  EXPECT_EQ(options.camera_node, "Eye");
}

TEST(Settings, WhatIsNoValueIsWrongUsageAndWhatIsOutOfRangeIsBadInput) {
  EXPECT_EQ(refusal("depth", "deep", ErrorKind::usage), "--depth deep: must be a whole number");
  EXPECT_EQ(refusal("depth", "99999", ErrorKind::input), "--depth 99999: must be between 0 and 4096");
  EXPECT_EQ(refusal("depth", "99999999999999999999", ErrorKind::input),
            "--depth 99999999999999999999: must be between 0 and 4096");
  EXPECT_EQ(refusal("cutoff", "nan", ErrorKind::input), "--cutoff nan: must be between 0 and 1");
  EXPECT_EQ(refusal("fps", "0", ErrorKind::input), "--fps 0: must be above 0 and at most 1000000");
  EXPECT_EQ(refusal("fps", "24/x", ErrorKind::usage), "--fps 24/x: must be a number, or a fraction such as 24000/1001");
  EXPECT_EQ(refusal("size", "0x9", ErrorKind::input), "--size 0x9: the width must be between 1 and 16384");
  EXPECT_EQ(refusal("spp", "adaptive:0.1:7", ErrorKind::input),
            "--spp adaptive:0.1:7: MOST must be between 8 and 65536");
  EXPECT_EQ(refusal("sort", "maybe", ErrorKind::usage), "--sort maybe: must be one of auto, on, off");
  EXPECT_EQ(refusal("quality", "best", ErrorKind::usage), "--quality best: must be one of draft, production, exact");
  EXPECT_EQ(refusal("aov", "Q", ErrorKind::usage), "--aov Q: there is Z, N, P, albedo, UV, id, tests, all");
  EXPECT_EQ(refusal("z-background", "1e39", ErrorKind::input), "--z-background 1e39: must be at most 3.4e38, or inf");
  EXPECT_EQ(refusal("frames", "5-1", ErrorKind::usage), "--frames \"5-1\": the last frame is before the first");
}

TEST(Settings, APresetCountsWhereNothingElseIsSaid) {
  const RenderOptions draft = read({{"depth", "9"}, {"quality", "draft"}});
  EXPECT_EQ(draft.settings.depth, 9U);
  EXPECT_FLOAT_EQ(draft.settings.cutoff, 0.02F);
  const RenderOptions exact = read({{"quality", "exact"}});
  EXPECT_EQ(text_of(exact.settings.samples), "adaptive:0.005:1024");
  EXPECT_EQ(exact.settings.depth, 32U);
  EXPECT_EQ(settings_json(exact).count("quality"), 0U) << "what it stands for is told";
}

TEST(Settings, WhatExcludesEachOtherIsRefused) {
  EXPECT_THROW((void)read({{"camera", "a.json"}, {"camera-node", "0"}}), Error);
  EXPECT_THROW((void)read({{"compression", "dwaa"}, {"aov", "all"}}), Error);
  EXPECT_NO_THROW((void)read({{"compression", "dwaa"}, {"aov", "Z,albedo"}}));
}

TEST(SettingsJson, TakesTheFormsOfEachType) {
  struct Case {
    const char* name;
    json value;
    const char* text;  // null: refused
  };
  const Case cases[] = {
      {"depth", 3, "3"},
      {"depth", "3", nullptr},
      {"depth", 1.5, nullptr},
      {"cutoff", 0.25, "0.25"},
      {"size", {32, 18}, "32x18"},
      {"size", {32}, nullptr},
      {"size", "32x18", "32x18"},
      {"environment", {0.5, 1, 2.5}, "0.5,1,2.5"},
      {"environment", {1, 2}, nullptr},
      {"aov", {"Z", "N"}, "Z,N"},
      {"aov", json::array(), nullptr},
      {"aov", {"Z,N"}, nullptr},
      {"spp", "adaptive:0.01", "adaptive:0.01"},
      {"spp", "4", nullptr},
      {"fps", "24000/1001", "24000/1001"},
      {"fps", "25", nullptr},
      {"camera-node", 1, "1"},
      {"camera-node", "1", "1"},
      {"camera-node", "a\nb", nullptr},
      {"animation", "", nullptr},
      {"frames", {1, 2}, "1,2"},
      {"frames", -2, "-2"},
      {"opaque", true, "true"},
      {"opaque", "true", nullptr},
      {"z-background", "inf", "inf"},
      {"z-background", "5", nullptr},
      {"strategy", nullptr, nullptr},
  };
  for (const Case& one : cases) {
    std::string text;
    const std::string reason = text_from_json(*find_setting(one.name), one.value, text);
    SCOPED_TRACE(one.name + (" " + one.value.dump()) + ": " + reason);
    EXPECT_EQ(reason.empty(), one.text != nullptr);
    if (reason.empty()) {
      EXPECT_EQ(text, one.text);
    }
  }
}

TEST(SettingsJson, TheSchemaHasRangesChoicesAndDefaults) {
  const auto schema = settings_schema();
  EXPECT_FALSE(schema.contains("out") || schema.contains("stats") || schema.contains("camera"));
  EXPECT_EQ(schema.at("cutoff").at("minimum"), 0);
  EXPECT_EQ(schema.at("cutoff").at("maximum"), 1);
  EXPECT_EQ(schema.at("cutoff").at("default"), 0.002);
  EXPECT_EQ(schema.at("instances").at("enum"), json({"auto", "copied", "shared"}));
  EXPECT_EQ(schema.at("preview").at("default"), true) << "the service's own";
  EXPECT_EQ(schema.at("aov").at("oneOf").back().at("items").at("enum").back(), "all");
  EXPECT_EQ(schema.at("fps").at("oneOf").front().at("exclusiveMinimum"), 0);
  EXPECT_EQ(schema.at("camera-node").at("oneOf").front().at("minimum"), 0);
}

TEST(SettingsJson, EverySettingIsDescribed) {
  const auto description = settings_description();
  ASSERT_EQ(description.size(), settings_table().size());
  for (const auto& entry : description)
    for (const char* key : {"name", "type", "range", "choices", "default", "unit", "help", "group", "http"})
      EXPECT_TRUE(entry.contains(key)) << entry.at("name") << " " << key;
}

}  // namespace
}  // namespace sheaf
