// SPDX-License-Identifier: MIT
// Names of layers, one by one and together.
#include "output/layer_set.hpp"

#include <gtest/gtest.h>

#include "core/error.hpp"

namespace sheaf {
namespace {

TEST(LayerSet, TakesEachNameForOneLayer) {
  for (const LayerName& one : layer_names) {
    const LayerSet set = parse_layers(one.name);
    for (const LayerName& other : layer_names) EXPECT_EQ(set.*other.layer, one.layer == other.layer) << one.name;
  }
  const LayerSet two = parse_layers("Z,id");
  EXPECT_TRUE(two.depth && two.id && !two.normal && !two.position && !two.albedo && !two.uv && !two.tests);
  EXPECT_FALSE(parse_layers("").any_surface());
}

TEST(LayerSet, AllIsEveryLayer) {
  const LayerSet set = parse_layers("all");
  for (const LayerName& one : layer_names) EXPECT_TRUE(set.*one.layer) << one.name;
}

TEST(LayerSet, RefusesOtherNamesAndSaysWhichThereAre) {
  EXPECT_EQ(list_of_layers(), "Z, N, P, albedo, UV, id, tests, all");
  for (const char* list : {"motion", "z", "Z,,N", "Z, N", "ID", " "}) {
    try {
      (void)parse_layers(list);
      FAIL() << list;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage);
      EXPECT_NE(std::string(error.what()).find(list_of_layers()), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace sheaf
