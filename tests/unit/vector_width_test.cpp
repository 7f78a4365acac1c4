// SPDX-License-Identifier: MIT
// Which drivers are asked for wider vectors, and what follows where vectors are not as wide as the driver's own.
#include "vulkan/vector_width.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <future>

#include "vulkan/buffer.hpp"
#include "vulkan/device.hpp"
#include "vulkan/recorder.hpp"

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

TEST(VectorWidth, EachWidthHasItsOwnCache) {
  ::setenv("MESA_SHADER_CACHE_DIR", "/given", 1);
  EXPECT_EQ(kernel_cache_folder(512), "/given/vectors_512");
  ::setenv("MESA_SHADER_CACHE_DIR", "/given/vectors_512", 1);
  EXPECT_EQ(kernel_cache_folder(512), "/given/vectors_512");
  ::unsetenv("MESA_SHADER_CACHE_DIR");
  ::setenv("XDG_CACHE_HOME", "/caches", 1);
  EXPECT_EQ(kernel_cache_folder(128), "/caches/sheaf/vectors_128");
  ::unsetenv("XDG_CACHE_HOME");
  ::setenv("HOME", "/home/one", 1);
  EXPECT_EQ(kernel_cache_folder(128), "/home/one/.cache/sheaf/vectors_128");
  ::unsetenv("HOME");
  EXPECT_EQ(kernel_cache_folder(128), "");
}

/// The queue would compile kernels of its own, and change under the maker's hands what it believes of vectors.
TEST(VectorWidth, TheQueueWaitsForKernelsThatAreMade) {
  ::setenv("LP_NATIVE_VECTOR_WIDTH", "128", 1);
  const Device device("");
  if (!device.limits().cpu) GTEST_SKIP() << "a GPU's driver compiles when a kernel is made";
  EXPECT_EQ(device.limits().subgroup, 4U);
  auto making = device.while_making();
  auto submitted = std::async(std::launch::async, [&] {
    Recorder recorder(device);
    const Buffer buffer(device, "anything", 64);
    recorder.fill(buffer, 1);
    recorder.submit_and_wait();
  });
  EXPECT_EQ(submitted.wait_for(std::chrono::milliseconds(100)), std::future_status::timeout);
  making.unlock();
  submitted.get();
}

}  // namespace
}  // namespace sheaf::test
