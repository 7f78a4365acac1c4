// SPDX-License-Identifier: MIT
// Who traces which batch, with costs worked out by hand.
#include "frame/strategy_trial.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace sheaf {
namespace {

struct Costs {  // ms per batch
  double bvh, hybrid;
};

// Batches of 1000 camera rays that become 2000, half of whose cost is tracing.
struct Played {
  std::vector<Strategy> by;
  double cost = 0;
};

template <typename CostOf>
Played play(StrategyTrial& trial, int batches, const CostOf& costs_of, int made_after = 0) {
  Played run;
  int wanted_since = -1;
  for (int b = 0; b < batches; ++b) {
    if (trial.wants_second() && wanted_since < 0) wanted_since = b;
    const Strategy by = trial.next(wanted_since >= 0 && b >= wanted_since + made_after);
    const Costs costs = costs_of(b);
    const double cost = by == Strategy::bvh ? costs.bvh : costs.hybrid;
    trial.took({by, cost, 2000, 1000, 0.5});
    run.by.push_back(by);
    run.cost += cost;
  }
  return run;
}

TrialTerms terms(int batches, double saving, double price_ms) {
  TrialTerms t;
  t.camera_rays = 1000.0 * batches;
  t.saving = saving;
  t.price_ms = price_ms;
  return t;
}

long count(const Played& run, Strategy s) { return std::count(run.by.begin(), run.by.end(), s); }

TEST(StrategyTrial, ShortRunsNeverAskForTheSecond) {
  // 9 batches of 100 ms remain, half of it tracing, of which 40 % might be saved: 180 ms for a price of 200.
  StrategyTrial trial(terms(10, 0.4, 200));
  const Played run = play(trial, 10, [](int) { return Costs{100, 1}; });
  EXPECT_EQ(count(run, Strategy::hybrid), 0);
  EXPECT_FALSE(trial.wants_second());
  EXPECT_EQ(trial.kept(), Strategy::bvh);
  EXPECT_NE(trial.because().find("0.18 s"), std::string::npos) << trial.because();
}

TEST(StrategyTrial, ALongerRunTakesTheCheaperFromTheSecondBatchOn) {
  StrategyTrial trial(terms(12, 0.4, 200));  // 11 x 20 ms
  const Played run = play(trial, 12, [](int) { return Costs{100, 80}; });
  EXPECT_EQ(run.by.front(), Strategy::bvh);
  EXPECT_EQ(count(run, Strategy::hybrid), 11);
  EXPECT_EQ(trial.kept(), Strategy::hybrid);
}

TEST(StrategyTrial, GoesOnByTheFirstWhileTheSecondsKernelsAreMade) {
  StrategyTrial trial(terms(20, 0.4, 200));
  const Played run = play(
      trial, 20,
      [](int) {
        return Costs{100, 80};
      },
      3);
  EXPECT_EQ(count(run, Strategy::bvh), 4);
}

TEST(StrategyTrial, TheDearerIsTriedForTwoBatches) {
  StrategyTrial trial(terms(100, 0.4, 200));
  const Played run = play(trial, 60, [](int) { return Costs{100, 150}; });
  EXPECT_EQ(count(run, Strategy::hybrid), 2);  // one that brings its kernels, one that counts
  EXPECT_EQ(trial.kept(), Strategy::bvh);
}

TEST(StrategyTrial, LooksAreRareWhereMuchIsAtStake) {
  StrategyTrial trial(terms(1000, 0.4, 200));
  const Played run = play(trial, 1000, [](int) { return Costs{120, 100}; });
  EXPECT_LE(run.cost, 1.005 * 1000 * 100);
}

TEST(StrategyTrial, LooksAgainWhenTheWorkChanges) {
  // From batch 40 on rays cost twice as much and more by hybrid, which had been the cheaper.
  StrategyTrial trial(terms(400, 0.4, 200));
  const Played run = play(trial, 400, [](int b) { return b < 40 ? Costs{100, 60} : Costs{200, 240}; });
  EXPECT_EQ(run.by[39], Strategy::hybrid);
  EXPECT_EQ(trial.kept(), Strategy::bvh);
  EXPECT_LE(count(run, Strategy::hybrid), 50);
}

TEST(StrategyTrial, AFirstBatchThatCompilesTellsNothing) {
  TrialTerms t = terms(10, 0.4, 200);
  t.compiles_first = true;
  StrategyTrial trial(t);
  const Played run = play(trial, 10, [](int b) { return b == 0 ? Costs{5000, 5000} : Costs{100, 80}; });
  EXPECT_EQ(count(run, Strategy::hybrid), 0);
}

TEST(StrategyTrial, WholeFramesOnlyMayLagBehind) {
  // Two batches a frame, of which only the first may change hands.
  StrategyTrial trial(terms(100, 0.4, 200));
  Strategy by = Strategy::bvh;
  for (int b = 0; b < 40; ++b) {
    if (b % 2 == 0) by = trial.next(true);
    trial.took({by, by == Strategy::bvh ? 100.0 : 80.0, 2000, 1000, 0.5});
  }
  EXPECT_EQ(trial.kept(), Strategy::hybrid);
}

TEST(StrategyTrial, NothingTracedIsNoMeasure) {
  StrategyTrial trial(terms(10, 0.4, 1));
  for (int b = 0; b < 10; ++b) trial.took({trial.next(true), 10, 0, 1000, 0.5});
  EXPECT_EQ(trial.kept(), Strategy::bvh);
  EXPECT_FALSE(trial.wants_second());
}

}  // namespace
}  // namespace sheaf
