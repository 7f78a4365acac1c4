// SPDX-License-Identifier: MIT
// Which drivers are asked for wider vectors.
#include "vulkan/vector_width.hpp"

#include <gtest/gtest.h>

namespace sheaf::test {
namespace {

TEST(VectorWidth, DriversFromMesa25OnGain) {
  for (const char* info :
       {"Mesa 25.0.7-2~bpo12+1 (LLVM 15.0.6)", "Mesa 25.0.0", "Mesa 26.1.0-devel (git-0123)", "Mesa 100.1"})
    EXPECT_TRUE(driver_gains_from_wide_vectors(info)) << info;
}

TEST(VectorWidth, OlderAndUnknownOnesDoNot) {
  for (const char* info : {"Mesa 22.3.6 (LLVM 15.0.6)", "Mesa 24.2.8-1ubuntu1", "Mesa ", "Mesa devel", "25.0.7", ""})
    EXPECT_FALSE(driver_gains_from_wide_vectors(info)) << info;
}

}  // namespace
}  // namespace sheaf::test
