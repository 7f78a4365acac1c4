// SPDX-License-Identifier: MIT
#include "interface/remap_workgroup.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace sheaf {
namespace {

constexpr std::uint32_t longest = 6;

std::vector<std::uint32_t> deal(std::uint32_t groups, std::uint32_t workers) {
  std::vector<std::uint32_t> work(groups);
  for (std::uint32_t g = 0; g < groups; ++g) work[g] = gpu::remap_workgroup(g, groups, workers, longest);
  return work;
}

void expect_each_once(std::vector<std::uint32_t> work, std::uint32_t workers) {
  const auto groups = static_cast<std::uint32_t>(work.size());
  std::sort(work.begin(), work.end());
  for (std::uint32_t g = 0; g < groups; ++g) ASSERT_EQ(work[g], g) << groups << " groups, " << workers << " workers";
}

TEST(RemapWorkgroup, EveryPieceIsDoneOnce) {
  for (const std::uint32_t workers : {1U, 2U, 3U, 5U, 8U, 16U, 48U, 96U, 256U})
    for (std::uint32_t groups = 0; groups < 1500; ++groups) expect_each_once(deal(groups, workers), workers);
}

TEST(RemapWorkgroup, EveryPieceOfLargeDispatchesIsDoneOnce) {
  for (const std::uint32_t workers : {2U, 3U, 7U, 64U, 127U, 256U})
    for (const std::uint32_t groups : {14'400U, 32'768U, 65'536U, 1'000'003U, (1U << 21) - 1, 1U << 21, (1U << 21) + 5})
      expect_each_once(deal(groups, workers), workers);
}

/// The driver's contiguous parts: each has about as much of any tenth of the work.
TEST(RemapWorkgroup, EachThreadHasAShareOfEveryPart) {
  for (const std::uint32_t workers : {2U, 3U, 4U, 16U})
    for (const std::uint32_t groups : {200U * workers, 14'400U, 100'000U}) {
      const auto work = deal(groups, workers);
      const std::uint32_t each = groups / workers, tenth = groups / 10;
      for (std::uint32_t w = 0; w < workers; ++w)
        for (std::uint32_t part = 0; part < 10; ++part) {
          const auto has = std::count_if(work.begin() + w * each, work.begin() + (w + 1) * each,
                                         [&](std::uint32_t p) { return p / tenth == part; });
          EXPECT_NEAR(static_cast<double>(has), tenth / double(workers), 64.0 + 0.1 * tenth / workers)
              << groups << " groups, worker " << w << " of " << workers << ", part " << part;
        }
    }
}

TEST(RemapWorkgroup, NeighboursStayTogetherWhereThereAreMany) {
  const auto work = deal(14'400, 2);
  int apart = 0;
  for (std::size_t g = 1; g < work.size(); ++g) apart += work[g] == work[g - 1] + 1 ? 0 : 1;
  EXPECT_LT(apart, 14'400 / 64 + 4);
}

}  // namespace
}  // namespace sheaf
