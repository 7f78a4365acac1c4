// SPDX-License-Identifier: MIT
// Packets are cut where they must be, and hold all rays; a packet with more pairs than there is room for loses none of
// them.
#include "device_world.hpp"

namespace sheaf::test {
namespace {

constexpr std::uint32_t kind = gpu::KIND_REFLECTION;

TEST(DevicePackets, PacketsAreCutWhereKeysChangeAndHoldEveryRay) {
  const Scan scan(device(), "packets");
  for (const std::uint32_t count : boundary_sizes()) {
    if (count > 100000) continue;
    Dice dice(count);
    std::vector<std::uint32_t> keys(count), counters(gpu::COUNT_WORDS, 0);
    std::vector<glm::uvec2> expected;
    for (std::uint32_t i = 0; i < count; ++i) {
      keys[i] = i > 0 && dice.below(40) != 0 ? keys[i - 1] : dice.below(5);
      if (i % gpu::BUNDLE == 0 || keys[i] != keys[i - 1]) expected.emplace_back(i, expected.size());
    }
    expected.emplace_back(count, expected.size());
    counters[gpu::COUNT_RAYS + kind] = count;
    const Buffer key_buffer = buffer_of(keys), counter_buffer = buffer_of(counters);
    const Output<glm::uvec2> packets(expected.size());
    const Buffer sums(device(), "block sums", (blocks_of(count) + 1) * 4ULL);
    Recorder recorder(device());
    recorder.bind(ROLE_PACKET_KEYS, key_buffer);
    recorder.bind(ROLE_COUNTERS, counter_buffer);
    recorder.bind(ROLE_PACKETS, packets.buffer());
    recorder.bind(ROLE_BLOCK_SUMS, sums);
    scan.record_blocks(recorder, gpu::KindPush{kind}, blocks_of(count));
    recorder.submit_and_wait();
    ASSERT_TRUE(packets.values() == expected) << count << " rays";
    ASSERT_EQ(read<std::uint32_t>(recorder, counter_buffer, gpu::COUNT_WORDS)[gpu::COUNT_CELLS], expected.size() - 1);
  }
}

/// Triangles one behind the other, in more leaves than there is room for pairs: no walk along them fits.
SceneBuilder tunnel() {
  Mesh mesh;
  for (std::uint32_t i = 0; i < 30000; ++i) {
    const float x = 0.01F * static_cast<float>(i);
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), {{x, 1, 0}, {x, 1.5F, 1}, {x, -1, 1.0F}});
    mesh.triangles.emplace_back(first, first + 1, first + 2);
  }
  SceneBuilder builder;
  builder.mesh(mesh, 0);
  return builder;
}

TEST(DevicePackets, NoPairIsDroppedWhereThereIsNoRoom) {
  Dice dice(5);
  std::vector<TestRay> rays(2000);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const double y = i < 1400 ? 0.9 : dice.range(-1, 1.5);
    rays[i].origin = glm::vec3(-1, y + 0.05 * dice.unit(), 0.5 * dice.unit());
    rays[i].direction = glm::vec3(glm::normalize(glm::dvec3(1, 1e-4 * dice.range(-1, 1), 3e-4 * dice.range(0, 1))));
  }
  const SceneBuilder scene = tunnel();
  const auto capacity = static_cast<std::uint32_t>(rays.size());
  DeviceWorld oracle(scene, {Strategy::bvh, SortPolicy::on, capacity});
  const auto nearest = oracle.trace(kind, rays), shadowed = oracle.trace(gpu::KIND_SHADOW, rays);
  for (const auto strategy : {Strategy::frustum, Strategy::classify}) {
    DeviceWorld world(scene, {strategy, SortPolicy::on, capacity, 1});
    ASSERT_GE(world.memory().capacity, capacity);
    EXPECT_TRUE(world.trace(kind, rays) == nearest) << name_of(strategy);
    const auto shadows = world.trace(gpu::KIND_SHADOW, rays);
    for (std::size_t i = 0; i < rays.size(); ++i)
      ASSERT_EQ(shadows[i] == ~0ULL, shadowed[i] == ~0ULL) << name_of(strategy) << ", ray " << i;
  }
}

}  // namespace
}  // namespace sheaf::test
