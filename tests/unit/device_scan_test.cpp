// SPDX-License-Identifier: MIT
#include <functional>

#include "device_fixture.hpp"
#include "stages/compact.hpp"
#include "stages/scan.hpp"

namespace sheaf::test {
namespace {

constexpr std::uint32_t head = 0x80000000U;
using Words = std::vector<std::uint32_t>;
using Pattern = std::pair<std::string, Words>;

struct Scanned {
  Words out;
  std::uint32_t total = 0;
};

enum class Dispatch { direct, indirect, too_many_groups };

Scanned run(const Scan& scan, const Words& in, Dispatch how) {
  const auto blocks = blocks_of(in.size());
  const Buffer values = buffer_of(in);
  const Buffer counters = buffer_of(Words{static_cast<std::uint32_t>(in.size()), 0xFFFFFFFFU});
  const Output<std::uint32_t> out(in.size()), sums(blocks);
  Words arguments(std::size_t{gpu::ARGS_COUNT} * 3);
  set_args(arguments, gpu::ARGS_BLOCKS, blocks);
  const Buffer args = buffer_of(arguments);
  Recorder recorder(device());
  recorder.bind(ROLE_SCAN_IN, values);
  recorder.bind(ROLE_SCAN_OUT, out.buffer());
  recorder.bind(ROLE_COUNTERS, counters);
  recorder.bind(ROLE_BLOCK_SUMS, sums.buffer());
  recorder.bind(ROLE_ARGS, args);
  if (how == Dispatch::indirect)
    scan.record(recorder, gpu::KindPush{}, gpu::ARGS_BLOCKS);
  else
    scan.record_blocks(recorder, gpu::KindPush{}, blocks + (how == Dispatch::too_many_groups ? 3 : 0));
  recorder.submit_and_wait();
  (void)sums.values();  // its guard
  return {out.values(), counters.view<std::uint32_t>()[1]};
}

Words made_of(std::uint32_t n, const std::function<std::uint32_t(std::uint32_t)>& value) {
  Words words(n);
  for (std::uint32_t i = 0; i < n; ++i) words[i] = value(i);
  return words;
}

/// Values whose sum stays below 2^31, as the scans want.
std::vector<Pattern> numbers(std::uint32_t n) {
  Dice dice(n + 1);
  const std::uint32_t most = (head - 1) / std::max(n, 1U);
  return {{"zeros", Words(n, 0)},
          {"ones", Words(n, 1)},
          {"flags", made_of(n, [&](auto) { return dice.below(2); })},
          {"random", made_of(n, [&](auto) { return dice.below(most); })},
          {"largest", Words(n, most)},
          {"first", made_of(n, [&](auto i) { return i == 0 ? head - 1 : 0; })},
          {"last", made_of(n, [&](auto i) { return i + 1 == n ? head - 1 : 0; })},
          {"rising", made_of(n, [&](auto i) { return i % 20000; })}};
}

TEST(DeviceScan, ExclusiveSumsEqualTheSerialOnes) {
  const Scan scan(device(), "plain");
  for (const auto n : boundary_sizes())
    for (const auto& [name, in] : numbers(n))
      for (const auto how : {Dispatch::direct, Dispatch::indirect, Dispatch::too_many_groups}) {
        const Scanned got = run(scan, in, how);
        std::uint32_t sum = 0;
        Words expected;
        for (const auto value : in) {
          expected.push_back(sum);
          sum += value;
        }
        ASSERT_EQ(got.total, sum) << name << ' ' << n;
        ASSERT_EQ(got.out, expected) << name << ' ' << n;
      }
}

std::vector<Pattern> segments(std::uint32_t n) {
  Dice dice(n + 7);
  auto value = [&] { return dice.below(1000); };
  return {{"no head", made_of(n, [&](auto) { return value(); })},
          {"all heads", made_of(n, [&](auto) { return head | value(); })},
          {"half heads", made_of(n, [&](auto) { return (dice.below(2) != 0 ? head : 0) | value(); })},
          {"few heads", made_of(n, [&](auto) { return (dice.below(700) == 0 ? head : 0) | value(); })},
          {"head first", made_of(n, [&](auto i) { return (i == 0 ? head : 0) | value(); })},
          {"head last", made_of(n, [&](auto i) { return (i + 1 == n ? head : 0) | value(); })},
          {"heads of zero", made_of(n, [&](auto i) { return i % 5 == 0 ? head : 1; })},
          {"heads at blocks", made_of(n, [&](auto i) { return (i % gpu::SCAN_BLOCK == 0 ? head : 0) | 1U; })},
          {"heads before blocks", made_of(n, [&](auto i) { return ((i + 1) % gpu::SCAN_BLOCK == 0 ? head : 0) | 1U; })},
          {"heads at runs", made_of(n, [&](auto i) { return (i % gpu::SCAN_RUN == 0 ? head : 0) | value(); })}};
}

TEST(DeviceScan, SegmentedSumsBeginAnewAtHeads) {
  const Scan scan(device(), "plain_segmented");
  for (const auto n : boundary_sizes())
    for (const auto& [name, in] : segments(n))
      for (const auto how : {Dispatch::direct, Dispatch::indirect}) {
        std::uint32_t sum = 0, seen = 0;
        Words expected;
        for (const auto value : in) {
          sum = (value & head) != 0 ? value & ~head : sum + value;
          seen |= value & head;
          expected.push_back(seen | sum);
        }
        const Scanned got = run(scan, in, how);
        ASSERT_EQ(got.out, expected) << name << ' ' << n;
        ASSERT_EQ(got.total, n == 0 ? 0 : expected.back()) << name << ' ' << n;
      }
}

std::vector<Pattern> choices(std::uint32_t n) {
  Dice dice(n + 3);
  return {{"none", Words(n, 0)},
          {"all", Words(n, 1)},
          {"random", made_of(n, [&](auto) { return dice.below(2); })},
          {"few", made_of(n, [&](auto) { return dice.below(100) == 0 ? 1 : 0; })},
          {"alternating", made_of(n, [&](auto i) { return i % 2; })},
          {"first", made_of(n, [&](auto i) { return i == 0 ? 1 : 0; })},
          {"last", made_of(n, [&](auto i) { return i + 1 == n ? 1 : 0; })}};
}

Words places_of(const Words& chosen, std::uint32_t flag) {
  Words places;
  for (std::uint32_t i = 0; i < chosen.size(); ++i)
    if (chosen[i] == flag) places.push_back(i);
  return places;
}

void expect_list_args(const Words& args, std::uint32_t rays) {
  Words expected = args;
  set_args(expected, gpu::ARGS_RAYS, blocks_of(rays, gpu::GROUP));
  set_args(expected, gpu::ARGS_BLOCKS, blocks_of(rays));
  set_args(expected, gpu::ARGS_BUNDLES, blocks_of(rays, device().limits().bundle));
  set_args(expected, gpu::ARGS_INCOHERENT, 0);
  set_args(expected, gpu::ARGS_ONE, std::min(rays, 1U));
  EXPECT_EQ(args, expected);
}

// Slots that hold rays, of `kind`, become a list; the device counts them for whoever comes next.
void check_compaction(const Compact& compact, const Words& holds_ray, std::uint32_t kind, bool counted_by_host) {
  const auto slots = static_cast<std::uint32_t>(holds_ray.size());
  std::vector<TestRay> rays(slots);
  for (std::uint32_t i = 0; i < slots; ++i) rays[i].pixel = holds_ray[i] != 0 ? i * 7 : gpu::NO_INDEX;
  const Words expected = places_of(holds_ray, 1);
  const std::uint32_t capacity = slots + 5;
  RayList list;
  list.rays = buffer_of(pack_rays(rays, capacity));
  list.hits = buffer_of(Words(1));
  list.order = buffer_of(Words(slots));
  Words counters(gpu::COUNT_WORDS), arguments(std::size_t{gpu::ARGS_COUNT} * 3);
  counters[gpu::COUNT_SLOTS + kind] = slots;
  counters[gpu::COUNT_INCOHERENT] = 7;  // of the list before
  set_args(arguments, kind == gpu::KIND_SHADOW ? gpu::ARGS_SLOTS_SHADOW : gpu::ARGS_SLOTS, blocks_of(slots));
  set_args(arguments, gpu::ARGS_INCOHERENT, 7);
  std::vector<std::uint64_t> stats(gpu::STAT_SUMS);
  stats[kind * gpu::STAT_FIELDS + gpu::STAT_RAYS] = 1ULL << 40U;  // of generations before
  gpu::Frame frame{};
  frame.capacity = capacity;
  const Buffer counter_words = buffer_of(counters), args = buffer_of(arguments), stat_words = buffer_of(stats);
  const Buffer frame_words = buffer_of(std::vector{frame});
  const Output<std::uint32_t> sums(blocks_of(slots));
  Recorder recorder(device());
  recorder.bind(ROLE_FRAME, frame_words);
  recorder.bind(ROLE_COUNTERS, counter_words);
  recorder.bind(ROLE_ARGS, args);
  recorder.bind(ROLE_STATS, stat_words);
  recorder.bind(ROLE_BLOCK_SUMS, sums.buffer());
  if (counted_by_host)
    compact.record_all(recorder, list, kind, slots);
  else
    compact.record(recorder, list, kind);
  recorder.submit_and_wait();
  EXPECT_EQ(counter_words.view<std::uint32_t>()[gpu::COUNT_RAYS + kind], expected.size());
  EXPECT_EQ(counter_words.view<std::uint32_t>()[gpu::COUNT_INCOHERENT], 0);
  EXPECT_EQ(read<std::uint32_t>(recorder, list.order, expected.size()), expected);
  EXPECT_EQ(stat_words.view<std::uint64_t>()[kind * gpu::STAT_FIELDS], (1ULL << 40U) + expected.size());
  expect_list_args(read<std::uint32_t>(recorder, args, std::size_t{gpu::ARGS_COUNT} * 3),
                   static_cast<std::uint32_t>(expected.size()));
  (void)sums.values();
}

TEST(DeviceCompact, RaysKeepTheOrderOfTheirSlots) {
  const Compact compact(device());
  for (const auto n : boundary_sizes())
    for (const auto& [name, holds_ray] : choices(n))
      for (const std::uint32_t kind : {gpu::KIND_PRIMARY, gpu::KIND_SHADOW, gpu::KIND_REFRACTION}) {
        SCOPED_TRACE(name + " " + std::to_string(n) + " kind " + std::to_string(kind));
        check_compaction(compact, holds_ray, kind, kind == gpu::KIND_PRIMARY);
        if (HasFailure()) return;
      }
}

TEST(DeviceCompact, SurvivingPairsKeepTheirOrder) {
  const Scan scan(device(), "pairs");
  for (const auto n : boundary_sizes())
    for (const auto& [name, survives] : choices(n)) {
      std::vector<glm::uvec2> pairs(n), expected;
      for (std::uint32_t i = 0; i < n; ++i) {
        pairs[i] = {i * 3, i ^ 0x5555U};
        if (survives[i] != 0) expected.push_back(pairs[i]);
      }
      Words counters(gpu::COUNT_WORDS, 77);
      counters[gpu::COUNT_PAIRS] = n;
      const Buffer candidates = buffer_of(pairs), flags = buffer_of(survives), words = buffer_of(counters);
      const Output<glm::uvec2> next(expected.size());
      const Output<std::uint32_t> sums(blocks_of(n));
      Recorder recorder(device());
      recorder.bind(ROLE_PAIRS, candidates);
      recorder.bind(ROLE_SURVIVORS, flags);
      recorder.bind(ROLE_PAIRS_NEXT, next.buffer());
      recorder.bind(ROLE_COUNTERS, words);
      recorder.bind(ROLE_BLOCK_SUMS, sums.buffer());
      scan.record_blocks(recorder, gpu::KindPush{}, blocks_of(n));
      recorder.submit_and_wait();
      ASSERT_EQ(words.view<std::uint32_t>()[gpu::COUNT_SURVIVORS], expected.size()) << name << ' ' << n;
      ASSERT_TRUE(next.values() == expected) << name << ' ' << n;
      (void)sums.values();
    }
}

}  // namespace
}  // namespace sheaf::test
