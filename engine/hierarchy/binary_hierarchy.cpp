// SPDX-License-Identifier: MIT
// Each range of primitives is cut where the surface area heuristic says: middles are dropped into bins along all
// three axes, and the cheapest plane between bins wins. About 15 ns a primitive and level; ranges are cut by one thread
// each, but for the first few, whose bins are filled by all. Filling merges by min, max and integer sums, so
// the tree is the same for any number of threads.
#include "hierarchy/binary_hierarchy.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <thread>

#include "hierarchy/binning.hpp"

namespace sheaf {
namespace {

using simd::Bounds;
using simd::Primitive;
using simd::Vec4;

constexpr std::uint32_t shared_from = 1u << 17;  // ranges from this size on have their bins filled by all threads
constexpr std::uint32_t node_chunk = 128;        // nodes a task takes from the pool at once

/// Levels a balanced tree needs over so many primitives.
std::uint32_t balanced_height(std::uint32_t count, std::uint32_t leaf_size) {
  const std::uint32_t leaves = (count + leaf_size - 1) / leaf_size;
  return static_cast<std::uint32_t>(std::bit_width(leaves - 1));
}

class Builder {
 public:
  Builder(std::span<const Box> boxes, const HierarchyOptions& options, std::uint32_t max_height)
      : options_(options), max_height_(max_height), threads_(std::max(1u, options.threads)), primitives_(boxes.size()) {
    const auto count = static_cast<std::uint32_t>(boxes.size());
    task_size_ = threads_ == 1 ? count : std::max(1024u, count / (threads_ * 8));
    // 2n - 1 nodes at most, and a chunk that each pool may leave unused. Pages that are never touched cost nothing.
    nodes_ = std::make_unique_for_overwrite<BinaryNode[]>(std::size_t{count} * 2 + node_chunk * (threads_ + 2));
    for (std::uint32_t i = 0; i < count; ++i) primitives_[i] = Primitive::of(boxes[i], i);
  }

  BinaryHierarchy build() {
    const Range all = whole(0, static_cast<std::uint32_t>(primitives_.size()));
    Pool top{0, 0};
    (void)take(top, 1);
    cut(all, 0, 0, top, true);
    run_tasks();
    finish_heights();
    BinaryHierarchy result{std::move(nodes_), {}};
    result.order.reserve(primitives_.size());
    for (const Primitive& p : primitives_) result.order.push_back(p.number());
    return result;
  }

 private:
  struct Pool {
    std::uint32_t next, end;
  };
  struct Task {
    Range range;
    std::uint32_t node, depth;
  };

  std::uint32_t take(Pool& pool, std::uint32_t count) {
    if (pool.end - pool.next < count) {
      pool.next = used_.fetch_add(node_chunk, std::memory_order_relaxed);
      pool.end = pool.next + node_chunk;
    }
    const std::uint32_t at = pool.next;
    pool.next += count;
    return at;
  }

  std::span<Primitive> primitives(const Range& range) {
    return std::span(primitives_).subspan(range.first, range.count);
  }

  /// Builds the subtree of `range` at `node`; recursion is as deep as the tree, so at most max_height.
  /// `top`: ranges small enough become tasks, and heights are left to finish_heights().
  std::uint32_t cut(const Range& range, std::uint32_t node, std::uint32_t depth, Pool& pool, bool top) {
    if (top && threads_ > 1 && range.count <= task_size_) {
      tasks_.push_back({range, node, depth});
      return 0;
    }
    BinaryNode& here = nodes_[node];
    here = {range.bounds.box(), range.first, range.count, 0, 0};
    if (range.count == 1) return 0;
    Range left, right;
    if (!split(range, depth, left, right)) return 0;
    here.left = take(pool, 2);
    if (top) inner_.push_back(node);
    const std::uint32_t a = cut(left, here.left, depth + 1, pool, top);
    const std::uint32_t b = cut(right, here.left + 1, depth + 1, pool, top);
    here.height = 1 + std::max(a, b);
    return here.height;
  }

  /// False where the range should be a leaf.
  bool split(const Range& range, std::uint32_t depth, Range& left, Range& right) {
    const bool may_be_leaf = range.count <= options_.leaf_size;
    const Binning binning(range);
    const Split best = best_split(range, binning);
    if (may_be_leaf) {
      const float area = range.bounds.half_area();
      const float apart = options_.traversal_cost * area + options_.intersection_cost * best.cost;
      if (best.axis < 0 || !(apart < options_.intersection_cost * area * static_cast<float>(range.count))) return false;
    }
    if (best.axis >= 0) {
      if (range.count <= few) {
        cut_sorted(range, best, left, right);
      } else {
        partition(range, binning, best, left, right);
      }
    }
    if (best.axis < 0 || !fits(left, depth + 1) || !fits(right, depth + 1)) {
      if (may_be_leaf) return false;
      halve(range, left, right);
    }
    return true;
  }

  /// Whether a balanced tree over the range still ends within the bound; halving keeps this true.
  [[nodiscard]] bool fits(const Range& range, std::uint32_t depth) const {
    return range.count > 0 && depth + balanced_height(range.count, options_.leaf_size) <= max_height_;
  }

  Split best_split(const Range& range, const Binning& binning) {
    if (range.count <= few) return sweep_few(primitives(range));
    if (binning.useless()) return {};
    Bins bins(binning.bins);
    if (range.count >= shared_from && threads_ > 1 && tasks_open_) {
      fill_shared(bins, range, binning);
    } else {
      binning.fill(bins, primitives(range));
    }
    Split best;
    for (int axis = 0; axis < 3; ++axis) {
      if (binning.scale[axis] != 0) sweep_axis(bins, binning.bins, axis, range.count, best);
    }
    return best;
  }

  void fill_shared(Bins& bins, const Range& range, const Binning& binning) {
    std::vector<Bins> parts(threads_ - 1, Bins(binning.bins));
    std::vector<std::jthread> helpers;
    const auto all = primitives(range);
    const std::size_t share = all.size() / threads_;
    for (std::size_t i = 0; i + 1 < threads_; ++i) {
      helpers.emplace_back([&, i] { binning.fill(parts[i], all.subspan(i * share, share)); });
    }
    binning.fill(bins, all.subspan((threads_ - 1) * share));
    helpers.clear();
    for (const Bins& part : parts) bins.add(part, binning.bins);
  }

  void partition(const Range& range, const Binning& binning, const Split& best, Range& left, Range& right) {
    left = right = {};
    std::uint32_t i = range.first, j = range.first + range.count;
    while (i < j) {
      Primitive& p = primitives_[i];
      const Vec4 middle = p.middle();
      if (binning.bin(middle)[best.axis] < static_cast<std::int32_t>(best.bin)) {
        left.bounds.add(p.bounds);
        left.middles.add(middle);
        ++i;
      } else {
        right.bounds.add(p.bounds);
        right.middles.add(middle);
        std::swap(p, primitives_[--j]);
      }
    }
    left.first = range.first;
    left.count = i - range.first;
    right.first = i;
    right.count = range.count - left.count;
  }

  void cut_sorted(const Range& range, const Split& best, Range& left, Range& right) {
    const auto all = primitives(range);
    const Sorted place = sort_few(all, best.axis);
    std::array<Primitive, few> copy;
    std::copy(all.begin(), all.end(), copy.begin());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = copy[place[i]];
    left = whole(range.first, best.left_count);
    right = whole(range.first + best.left_count, range.count - best.left_count);
  }

  /// Where the heuristic finds no plane, or would go too deep: two halves along the axis on which the middles spread
  /// most. The number breaks ties, so that even equal boxes keep their order.
  void halve(const Range& range, Range& left, Range& right) {
    const Vec4 spread = range.middles.hi - range.middles.lo;
    int axis = 0;
    for (int a = 1; a < 3; ++a) {
      if (spread[a] > spread[axis]) axis = a;
    }
    const auto all = primitives(range);
    const auto half = (range.count + 1) / 2;
    std::nth_element(all.begin(), all.begin() + half, all.end(), [axis](const Primitive& a, const Primitive& b) {
      const float at_a = a.middle()[axis], at_b = b.middle()[axis];
      return at_a < at_b || (at_a == at_b && a.number() < b.number());
    });
    left = whole(range.first, half);
    right = whole(range.first + half, range.count - half);
  }

  Range whole(std::uint32_t first, std::uint32_t count) {
    Range range;
    range.first = first;
    range.count = count;
    for (const Primitive& p : primitives(range)) {
      range.bounds.add(p.bounds);
      range.middles.add(p.middle());
    }
    return range;
  }

  void run_tasks() {
    tasks_open_ = false;
    if (tasks_.empty()) return;
    std::vector<std::uint32_t> by_size(tasks_.size());
    for (std::uint32_t i = 0; i < by_size.size(); ++i) by_size[i] = i;
    std::stable_sort(by_size.begin(), by_size.end(),
                     [&](auto a, auto b) { return tasks_[a].range.count > tasks_[b].range.count; });
    std::atomic<std::size_t> next{0};
    const auto work = [&] {
      Pool pool{0, 0};
      for (std::size_t i; (i = next.fetch_add(1)) < by_size.size();) {
        const Task& task = tasks_[by_size[i]];
        cut(task.range, task.node, task.depth, pool, false);
      }
    };
    std::vector<std::jthread> helpers;
    for (std::uint32_t i = 1; i < threads_; ++i) helpers.emplace_back(work);
    work();
  }

  void finish_heights() {
    for (auto node = inner_.rbegin(); node != inner_.rend(); ++node) {
      BinaryNode& n = nodes_[*node];
      n.height = 1 + std::max(nodes_[n.left].height, nodes_[n.left + 1].height);
    }
  }

  HierarchyOptions options_;
  std::uint32_t max_height_, threads_, task_size_ = 0;
  std::vector<Primitive> primitives_;
  std::unique_ptr<BinaryNode[]> nodes_;
  std::atomic<std::uint32_t> used_{0};
  std::vector<Task> tasks_;
  std::vector<std::uint32_t> inner_;  // nodes cut before the tasks ran, parents first
  bool tasks_open_ = true;            // no task runs yet: all threads are free to share one range
};

}  // namespace

BinaryHierarchy build_binary_hierarchy(std::span<const Box> boxes, const HierarchyOptions& options,
                                       std::uint32_t max_height) {
  return Builder(boxes, options, max_height).build();
}

}  // namespace sheaf
