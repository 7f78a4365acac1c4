// SPDX-License-Identifier: MIT
// Compression, radix sort and decompression (R 4.2): each against a serial version, and the whole chain against a
// stable sort.
#include <numeric>

#include "device_world.hpp"
#include "stages/sort.hpp"

namespace sheaf::test {
namespace {

using Words = std::vector<std::uint32_t>;
constexpr std::uint32_t kind = gpu::KIND_REFLECTION;

struct Chunk {
  std::uint32_t key, base, size;
  friend bool operator==(const Chunk&, const Chunk&) = default;
};

struct Keys {
  std::string name;
  Words keys;
};

std::vector<Keys> key_patterns(std::uint32_t n, std::uint32_t bits) {
  Dice dice(n + bits);
  const std::uint32_t mask = bits == 32 ? 0xFFFFFFFFU : (1U << bits) - 1;
  Words falling(n), few(n), runs(n), random(n), wobble(n);
  std::uint32_t run_key = 0;
  for (std::uint32_t i = 0; i < n; ++i) {
    falling[i] = (n - i) & mask;
    few[i] = dice.below(3) * (mask / 3);
    if (dice.below(20) == 0) run_key = dice.word() & mask;
    runs[i] = run_key;
    random[i] = dice.word() & mask;
    wobble[i] = (i + (i % 2) * 40) & mask;
  }
  Words sorted = random, different(n);
  std::sort(sorted.begin(), sorted.end());
  std::iota(different.begin(), different.end(), 0U);
  for (std::uint32_t i = n; i > 1; --i) std::swap(different[i - 1], different[dice.below(i)]);
  for (auto& key : different) key &= mask;
  return {{"all equal", Words(n, mask)},
          {"all different", different},
          {"sorted", sorted},
          {"reverse", falling},
          {"random", random},
          {"three keys", few},
          {"runs", runs},
          {"nearly sorted", wobble}};
}

/// The stages of SortRays one by one, over keys of the test's choice.
class Chain {
 public:
  Chain(std::uint32_t rays, std::uint32_t capacity)
      : world_(SceneBuilder(), {Strategy::hybrid, SortPolicy::on, capacity, 1024, false}),
        sort_(world_.context()),
        compress_(device(), "compress"),
        starts_(device(), "starts"),
        segmented_(device(), "segmented"),
        sizes_(run_kernel("compress_sizes")),
        fill_(run_kernel("decompress_fill")) {
    resize(rays);
  }

  void resize(std::uint32_t rays) { rays_ = rays; }

  void load(const Words& keys, const Words& order) {
    Recorder& r = world_.recorder();
    const RayMemory& m = world_.memory();
    world_.load(kind, std::vector<TestRay>(rays_));
    write(r, m.keys, keys);
    write(r, world_.list(kind).order, order);
    r.bind(ROLE_KEYS, m.keys);
    r.bind(ROLE_CHUNKS, m.chunks);
    r.bind(ROLE_SKELETON, m.skeleton);
    r.bind(ROLE_ORDER_KEPT, m.order_kept);
    for (const auto* scratch : {&m.chunks, &m.chunks_alt, &m.skeleton, &m.order_kept, &m.digits})
      r.fill(*scratch, 0xEEEEEEEEU);
  }
  void compress() {
    compress_.record(world_.recorder(), gpu::KindPush{kind}, gpu::ARGS_BLOCKS);
    world_.recorder().dispatch_indirect(sizes_, gpu::KindPush{kind}, gpu::ARGS_CHUNKS);
  }
  void sort(std::uint32_t bits) { in_alt_ = sort_.record_passes(world_.recorder(), world_.memory(), bits); }
  void decompress() {
    world_.recorder().dispatch_indirect(fill_, gpu::KindPush{kind}, gpu::ARGS_BLOCKS);
    starts_.record(world_.recorder(), gpu::KindPush{kind}, gpu::ARGS_CHUNKS);
    segmented_.record(world_.recorder(), gpu::KindPush{kind}, gpu::ARGS_BLOCKS);
  }

  std::uint32_t counter(std::uint32_t index) {
    return read<std::uint32_t>(world_.recorder(), world_.memory().counters, gpu::COUNT_WORDS)[index];
  }
  std::vector<Chunk> chunks(std::size_t count) {
    return read<Chunk>(world_.recorder(), in_alt_ ? world_.memory().chunks_alt : world_.memory().chunks, count);
  }
  Words order() { return read<std::uint32_t>(world_.recorder(), world_.list(kind).order, rays_); }
  Words kept() { return read<std::uint32_t>(world_.recorder(), world_.memory().order_kept, rays_); }

 private:
  static Kernel run_kernel(const char* stem) {
    const SpecConstant group{SPEC_GROUP, gpu::SCAN_GROUP};
    return {device(), stem, {&group, 1}};
  }

  std::uint32_t rays_ = 0;
  DeviceWorld world_;
  SortRays sort_;
  Scan compress_, starts_, segmented_;
  Kernel sizes_, fill_;
  bool in_alt_ = false;
};

std::vector<Chunk> serial_chunks(const Words& keys) {
  std::vector<Chunk> chunks;
  for (std::uint32_t i = 0; i < keys.size(); ++i) {
    if (i == 0 || keys[i] != keys[i - 1]) chunks.push_back({keys[i], i, 0});
    ++chunks.back().size;
  }
  return chunks;
}

Words some_order(std::uint32_t n) {  // slots with gaps, in no order
  Words order(n);
  std::iota(order.begin(), order.end(), 1000U);
  Dice dice(n);
  for (std::uint32_t i = n; i > 1; --i) std::swap(order[i - 1], order[dice.below(i)]);
  return order;
}

Words stable_order(const Words& keys, const Words& order) {
  Words places(keys.size()), sorted;
  std::iota(places.begin(), places.end(), 0U);
  std::stable_sort(places.begin(), places.end(), [&](auto a, auto b) { return keys[a] < keys[b]; });
  for (const auto place : places) sorted.push_back(order[place]);
  return sorted;
}

TEST(DeviceSort, EveryStageEqualsItsSerialVersion) {
  Chain chain(0, boundary_sizes().back());
  for (const auto n : boundary_sizes())
    for (const std::uint32_t bits : n < 4096 ? Words{4, 12, 32} : Words{32})  // one pass, three, eight
      for (const auto& [name, keys] : key_patterns(n, bits)) {
        SCOPED_TRACE(name + ", " + std::to_string(n) + " rays, " + std::to_string(bits) + " bits");
        const Words order = some_order(n);
        auto expected = serial_chunks(keys);
        chain.resize(n);
        chain.load(keys, order);
        chain.compress();
        chain.sort(0);
        ASSERT_EQ(chain.counter(gpu::COUNT_CHUNKS), expected.size());
        ASSERT_TRUE(chain.chunks(expected.size()) == expected) << "compression";
        ASSERT_EQ(chain.kept(), order);
        chain.sort(bits);
        std::stable_sort(expected.begin(), expected.end(), [](auto a, auto b) { return a.key < b.key; });
        ASSERT_TRUE(chain.chunks(expected.size()) == expected) << "sort";
        chain.decompress();
        ASSERT_EQ(chain.order(), stable_order(keys, order)) << "decompression";
      }
}

TEST(DeviceSort, MemoryOfExactlyTheRaysIsEnough) {
  for (const std::uint32_t n : {1024U, 1025U, 2048U, 2049U, 32U * 1024U, 32U * 1024U + 1U}) {
    Chain chain(n, n);
    const auto patterns = key_patterns(n, 32);
    const Words order = some_order(n);
    for (const auto& [name, keys] : patterns) {
      chain.load(keys, order);
      chain.compress();
      chain.sort(32);
      chain.decompress();
      ASSERT_EQ(chain.order(), stable_order(keys, order)) << name << ' ' << n;
    }
  }
}

// The stage as the tracers record it: whatever keys hash gave, the order is the stable sort by them.
TEST(DeviceSort, RaysAreInTheOrderOfTheirKeys) {
  DeviceWorld world(SceneBuilder(), {Strategy::crsh, SortPolicy::on, 70000, 1024, false});
  const SortRays sort(world.context());
  for (const std::uint32_t of_kind : {gpu::KIND_REFLECTION, gpu::KIND_SHADOW})
    for (const std::uint32_t n : {0U, 1U, 2U, 33U, 1023U, 1024U, 1025U, 2049U, 32769U, 70000U}) {
      Dice dice(n);
      std::vector<TestRay> rays(n);
      for (auto& ray : rays) {
        ray.origin = glm::vec3(dice.cube() * 10.0);
        ray.direction = glm::vec3(dice.direction());
        if (dice.below(10) == 0) ray.pixel = gpu::NO_INDEX;  // a slot without a ray
      }
      Words order;
      for (std::uint32_t i = 0; i < n; ++i)
        if (rays[i].pixel != gpu::NO_INDEX) order.push_back(i);
      world.load(of_kind, rays);
      sort.record(world.recorder(), world.context(), of_kind);
      const Words keys = read<std::uint32_t>(world.recorder(), world.memory().keys, order.size());
      const auto bits = key_layout(of_kind, 1, world.memory().tile_pixels).bits();
      for (const auto key : keys) ASSERT_EQ(std::uint64_t{key} >> bits, 0U) << "a key of more bits than are sorted";
      ASSERT_EQ(read<std::uint32_t>(world.recorder(), world.list(of_kind).order, order.size()),
                stable_order(keys, order))
          << n << " rays of kind " << of_kind;
    }
}

}  // namespace
}  // namespace sheaf::test
