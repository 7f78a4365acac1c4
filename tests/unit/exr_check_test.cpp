// SPDX-License-Identifier: MIT
// Whether a frame's file is whole: what --resume relies on.
#include <random>

#include "core/choice.hpp"
#include "exr_support.hpp"

namespace sheaf {
namespace {

using test::attributes;
using test::contents;
using test::full;
using test::put;

class ExrCheckTest : public test::OutputTest {};

TEST_F(ExrCheckTest, WholeMeansEveryByteIsThere) {
  for (const Compression compression : {Compression::none, Compression::zip, Compression::piz}) {
    SCOPED_TRACE(name_of(compression));
    write_exr(path("a.exr"), full(8, 40), attributes(), compression);
    const std::string whole = contents(path("a.exr"));
    ASSERT_TRUE(exr_is_whole(path("a.exr"), 8, 40));
    EXPECT_FALSE(exr_is_whole(path("a.exr"), 8, 41));
    EXPECT_FALSE(exr_is_whole(path("a.exr"), 40, 8));
    for (std::size_t size = 0; size < whole.size(); size += size + 150 < whole.size() ? 150 : 3) {
      put(path("cut.exr"), whole.substr(0, size));
      ASSERT_FALSE(exr_is_whole(path("cut.exr"), 8, 40)) << size << " of " << whole.size();
    }
  }
}

TEST_F(ExrCheckTest, WholeNeverThrows) {
  EXPECT_FALSE(exr_is_whole(path("missing.exr"), 1, 1));
  EXPECT_FALSE(exr_is_whole(folder_, 1, 1));
  EXPECT_FALSE(exr_is_whole("", 1, 1));
  put(path("text.exr"), "not a picture");
  EXPECT_FALSE(exr_is_whole(path("text.exr"), 1, 1));
  write_exr(path("a.exr"), full(8, 40), attributes(), Compression::zip);
  const std::string whole = contents(path("a.exr"));
  std::mt19937 random(1);
  for (int i = 0; i < 300; ++i) {
    std::string broken = whole;
    for (int j = 0; j < 3; ++j) broken[random() % broken.size()] = static_cast<char>(random());
    put(path("broken.exr"), broken);
    (void)exr_is_whole(path("broken.exr"), 8, 40);
  }
}

}  // namespace
}  // namespace sheaf
