// SPDX-License-Identifier: MIT
// Packets and their frustums (frustum.glsl): no box is culled that some ray of the packet may enter, by the float slab
// test that hits must pass and in double precision, over magnitudes.
#include <bit>
#include <cmath>

#include "device_world.hpp"
#include "interface/push/cells.h"

namespace sheaf::test {
namespace {

constexpr std::uint32_t kind = gpu::KIND_REFLECTION;
using Rays = std::vector<TestRay>;

std::uint32_t face_of(const glm::vec3& d) {
  const glm::vec3 a = glm::abs(d);
  const int axis = a.x >= a.y && a.x >= a.z ? 0 : a.y >= a.z ? 1 : 2;
  return 2 * static_cast<std::uint32_t>(axis) + (d[axis] < 0 ? 1 : 0);
}

struct Grid {  // a node's boxes, as the kernels read them
  glm::vec3 origin{0};
  glm::uvec3 exponent{127};
  glm::uvec3 lo[gpu::WIDE]{}, hi[gpu::WIDE]{};
  [[nodiscard]] glm::vec3 at(const glm::uvec3& place) const {
    return origin + glm::vec3(place) * glm::vec3(std::bit_cast<float>(exponent.x << 23U),
                                                 std::bit_cast<float>(exponent.y << 23U),
                                                 std::bit_cast<float>(exponent.z << 23U));
  }
};

void pack(const Grid& grid, std::uint32_t* words) {
  for (int axis = 0; axis < 3; ++axis) {
    words[axis] = std::bit_cast<std::uint32_t>(grid.origin[axis]);
    words[gpu::NODE_STEPS] |= grid.exponent[axis] << (8U * static_cast<unsigned>(axis));
    for (std::uint32_t c = 0; c < gpu::WIDE; ++c) {
      const std::uint32_t word = gpu::NODE_BOXES + 2 * static_cast<std::uint32_t>(axis) + c / 4;
      words[word] |= grid.lo[c][axis] << (8 * (c % 4));
      words[word + 6] |= grid.hi[c][axis] << (8 * (c % 4));
    }
  }
  words[gpu::NODE_STEPS] |= 0xFFU << 24U;
}

/// All of one face: about one axis, with origins and directions spread by shares of size and of the half circle; some
/// from one point, as shadow rays turned round are, some along one way, some with a beginning and an end.
Rays packet_of(Dice& dice, double size, std::size_t count) {
  const glm::dvec3 place = dice.cube() * size, axis = dice.direction();
  const double apart = dice.below(4) == 0 ? 0 : size * dice.magnitude(1e-7, 0.5);
  const double spread = dice.below(4) == 0 ? 0 : dice.magnitude(1e-7, 1);
  const bool ended = dice.below(2) == 0;
  Rays rays;
  while (rays.size() < count) {
    TestRay ray;
    ray.origin = glm::vec3(place + dice.cube() * apart);
    glm::dvec3 way = axis + dice.cube() * spread;
    if (dice.below(16) == 0) way[static_cast<int>(dice.below(3))] *= 1e-20;
    ray.direction = glm::vec3(glm::normalize(way));
    if (ended) ray.tmin = static_cast<float>(size * dice.magnitude(1e-6, 0.1));
    if (ended) ray.tmax = ray.tmin + static_cast<float>(size * dice.magnitude(1e-3, 4));
    if (rays.empty() || face_of(ray.direction) == face_of(rays.front().direction)) rays.push_back(ray);
  }
  return rays;
}

/// Boxes about a place that one of the rays comes by, within rounding of their lowest corner.
Grid boxes_by(Dice& dice, const TestRay& ray, double size) {
  const double t = std::clamp(size * dice.magnitude(1e-4, 3), double{ray.tmin}, double{ray.tmax});
  Grid grid;
  const glm::dvec3 point = glm::dvec3(ray.origin) + glm::dvec3(ray.direction) * t;
  for (int axis = 0; axis < 3; ++axis) {
    const double off = size * std::exp2(-24) * dice.range(-4, 4);
    grid.origin[axis] = static_cast<float>(std::clamp(point[axis] + off, -2 * size, 2 * size));
    const int power = static_cast<int>(std::floor(std::log2(size))) - 8 - static_cast<int>(dice.below(24));
    grid.exponent[axis] = static_cast<std::uint32_t>(std::clamp(power + 127, 2, 253));
  }
  for (std::uint32_t c = 0; c < gpu::WIDE; ++c)
    for (int axis = 0; axis < 3; ++axis) {
      grid.lo[c][axis] = dice.below(2) == 0 ? 0 : dice.below(256);
      grid.hi[c][axis] = std::min(255U, grid.lo[c][axis] + (dice.below(3) == 0 ? 0 : dice.below(256)));
    }
  return grid;
}

/// triangle.glsl's slab test, operation by operation.
bool enters_as_floats(const TestRay& ray, const glm::vec3& lo, const glm::vec3& hi) {
  float entry = -std::numeric_limits<float>::infinity(), leave = -entry;
  for (int axis = 0; axis < 3; ++axis) {
    constexpr float tiny = 1e-18F;
    float d = ray.direction[axis];
    if (std::abs(d) < tiny) d = d < 0 ? -tiny : tiny;
    const float inverse = 1.0F / d;
    entry = std::max(entry, ((inverse < 0 ? hi : lo)[axis] - ray.origin[axis]) * inverse);
    leave = std::min(leave, ((inverse < 0 ? lo : hi)[axis] - ray.origin[axis]) * inverse);
  }
  return entry <= leave && leave >= ray.tmin && entry <= ray.tmax;
}

bool enters_exactly(const TestRay& ray, const glm::vec3& lo, const glm::vec3& hi) {
  double entry = ray.tmin, leave = ray.tmax;
  for (int axis = 0; axis < 3; ++axis) {
    const double o = ray.origin[axis], d = ray.direction[axis], a = lo[axis] - o, b = hi[axis] - o;
    if (d == 0 && (a > 0 || b < 0)) return false;
    if (d == 0) continue;
    entry = std::max(entry, std::min(a / d, b / d));
    leave = std::min(leave, std::max(a / d, b / d));
  }
  return entry <= leave;
}

struct Batch {
  Rays rays;
  std::vector<glm::uvec2> packets;
  std::vector<Grid> grids;  // a packet's own; the first: all there is
};

Batch random_batch(Dice& dice, double size, std::uint32_t count) {
  Batch batch;
  Grid all;
  all.origin = glm::vec3(static_cast<float>(-2.01 * size));  // holds every box, as a root's does
  all.exponent = glm::uvec3(static_cast<std::uint32_t>(std::clamp(std::ilogb(size) + 127 - 4, 2, 253)));
  for (auto& hi : all.hi) hi = glm::uvec3(255);
  batch.grids.push_back(all);
  for (std::uint32_t p = 0; p < count; ++p) {
    const Rays rays = packet_of(dice, size, 1 + dice.below(dice.below(2) == 0 ? 2 : gpu::BUNDLE));
    batch.packets.emplace_back(batch.rays.size(), p);
    batch.grids.push_back(boxes_by(dice, rays[dice.below(static_cast<std::uint32_t>(rays.size()))], size));
    batch.rays.insert(batch.rays.end(), rays.begin(), rays.end());
  }
  batch.packets.emplace_back(batch.rays.size(), count);
  return batch;
}

/// Which children each packet's frustum enters, of the node after the root's.
std::vector<std::uint32_t> entered_by(const Batch& batch) {
  const auto count = static_cast<std::uint32_t>(batch.packets.size() - 1);
  const auto rays = static_cast<std::uint32_t>(batch.rays.size());
  using Usage = vk::BufferUsageFlagBits;
  const Buffer nodes(device(), "nodes", batch.grids.size() * gpu::NODE_WORDS * 4, Buffer::Kind::upload,
                     Usage::eShaderDeviceAddress);
  std::fill_n(nodes.view<std::uint32_t>().begin(), batch.grids.size() * gpu::NODE_WORDS, 0U);
  for (std::size_t n = 0; n < batch.grids.size(); ++n)
    pack(batch.grids[n], &nodes.view<std::uint32_t>()[n * gpu::NODE_WORDS]);
  const Buffer frustums(device(), "frustums", std::uint64_t{count} * gpu::FRUSTUM_WORDS * 4, Buffer::Kind::device,
                        Usage::eShaderDeviceAddress);
  auto halves = [](std::uint64_t address) { return glm::uvec2(address & 0xFFFFFFFFU, address >> 32U); };
  gpu::Frame frame{};
  frame.capacity = rays;
  frame.nodes_at = halves(nodes.address());
  std::vector<std::uint32_t> order(rays), counters(gpu::COUNT_WORDS, 0);
  for (std::uint32_t i = 0; i < rays; ++i) order[i] = i;
  counters[gpu::COUNT_WALK_CELLS] = counters[gpu::COUNT_PAIR_HALVES] = count;
  std::vector<glm::uvec2> pairs;
  for (std::uint32_t i = 0; i < count; ++i) pairs.emplace_back(i, i + 1);
  const Buffer frame_buffer = buffer_of(std::vector{frame}), counter_buffer = buffer_of(counters),
               ray_buffer = buffer_of(pack_rays(batch.rays, rays)), order_buffer = buffer_of(order),
               packet_buffer = buffer_of(batch.packets), pair_buffer = buffer_of(pairs),
               levels = buffer_of(std::vector<std::uint32_t>(4, 0));
  const Output<std::uint32_t> entered(count);
  const Output<glm::uvec2> first_pairs(count), lists(count);
  const Kernel frustums_of(device(), "packets_frustums"), open(device(), "pairs_open");
  Recorder recorder(device());
  recorder.bind(ROLE_FRAME, frame_buffer);
  recorder.bind(ROLE_COUNTERS, counter_buffer);
  recorder.bind_list(LIST_RAYS, ray_buffer);
  recorder.bind_list(LIST_ORDER, order_buffer);
  recorder.bind(ROLE_PACKETS, packet_buffer);
  recorder.bind(ROLE_PAIRS, first_pairs.buffer());
  recorder.bind(ROLE_LISTS, lists.buffer());
  recorder.bind(ROLE_SURVIVORS, entered.buffer());
  recorder.bind(ROLE_PAIR_LEVELS, levels);
  const glm::uvec2 at = halves(frustums.address());
  recorder.dispatch(frustums_of, gpu::PacketsFrustumsPush{at}, blocks_of(count, gpu::GROUP));
  recorder.bind(ROLE_PAIRS, pair_buffer);
  const gpu::PairsOpenPush push{at, kind, 0, count, 0, 3, 0};
  recorder.dispatch(open, push, blocks_of(count, gpu::GROUP));
  recorder.submit_and_wait();
  const auto found = first_pairs.values();
  for (std::uint32_t i = 0; i < count; ++i) EXPECT_EQ(found[i], glm::uvec2(i, 0));
  return entered.values();
}

std::uint32_t slot_mask(std::uint32_t word) {  // from visiting order
  std::uint32_t mask = 0;
  for (std::uint32_t c = 0; c < gpu::WIDE; ++c)
    if ((word & (1U << c)) != 0) mask |= 1U << (c ^ (word >> gpu::PAIR_OCTANT));
  return mask;
}

TEST(DeviceFrustum, NoBoxIsCulledThatARayOfThePacketEnters) {
  constexpr std::uint32_t count = 8000;  // packets a magnitude, eight boxes each
  std::size_t entered = 0, missed = 0, culled = 0, boxes = 0;
  for (int power = -12; power <= 12; power += 2) {
    const double size = std::pow(10.0, power);
    Dice dice(static_cast<std::uint32_t>(power + 50));
    const Batch batch = random_batch(dice, size, count);
    const auto got = entered_by(batch);
    for (std::uint32_t p = 0; p < count; ++p) {
      const Grid& grid = batch.grids[p + 1];
      const std::uint32_t mask = slot_mask(got[p]);
      for (std::uint32_t c = 0; c < gpu::WIDE; ++c) {
        const glm::vec3 lo = grid.at(grid.lo[c]), hi = grid.at(grid.hi[c]);
        bool any = false;
        for (std::uint32_t r = batch.packets[p].x; r < batch.packets[p + 1].x && !any; ++r)
          any = enters_as_floats(batch.rays[r], lo, hi) || enters_exactly(batch.rays[r], lo, hi);
        const bool kept = (mask & (1U << c)) != 0;
        entered += any ? 1 : 0;
        missed += any && !kept ? 1 : 0;
        culled += kept ? 0 : 1;
        ++boxes;
      }
    }
    EXPECT_EQ(missed, 0U) << "at size " << size << ", of " << entered << " so far";
  }
  EXPECT_GT(entered, boxes / 25);
  EXPECT_GT(culled, boxes / 4) << "a frustum that meets everything bounds nothing";
}

// A single ray's frustum is a line with rounding about it: what is clearly off it is culled.
TEST(DeviceFrustum, BoxesOffASingleRayAreCulled) {
  constexpr std::uint32_t count = 20000;
  std::size_t off = 0, kept = 0;
  Dice dice(7);
  Batch batch;
  batch.grids = random_batch(dice, 1, 0).grids;
  for (std::uint32_t p = 0; p < count; ++p) {
    const Rays rays = packet_of(dice, 1, 1);
    batch.packets.emplace_back(p, p);
    batch.grids.push_back(boxes_by(dice, rays.front(), 1));
    batch.rays.push_back(rays.front());
  }
  batch.packets.emplace_back(count, count);
  const auto got = entered_by(batch);
  for (std::uint32_t p = 0; p < count; ++p) {
    const Grid& grid = batch.grids[p + 1];
    for (std::uint32_t c = 0; c < gpu::WIDE; ++c) {
      const glm::vec3 margin(1e-4F);
      if (enters_exactly(batch.rays[p], grid.at(grid.lo[c]) - margin, grid.at(grid.hi[c]) + margin)) continue;
      ++off;
      kept += (slot_mask(got[p]) & (1U << c)) != 0 ? 1 : 0;
    }
  }
  EXPECT_EQ(kept, 0U) << "of " << off;
  EXPECT_GT(off, std::size_t{count} / 2);
}

}  // namespace
}  // namespace sheaf::test
