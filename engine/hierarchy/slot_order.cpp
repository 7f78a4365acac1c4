// SPDX-License-Identifier: MIT
#include "hierarchy/slot_order.hpp"

namespace sheaf {

void order_slots(WideNode& node) {
  Box whole;
  for (std::uint32_t c = 0; c < wide; ++c) {
    if (node.child[c] == empty_child) continue;
    whole.lo = glm::min(whole.lo, node.bounds[c].lo);
    whole.hi = glm::max(whole.hi, node.bounds[c].hi);
  }
  // How far child c lies towards the corner that slot s stands for. Scaled first: sums of huge boxes stay finite.
  auto gain = [&](std::uint32_t c, std::uint32_t s) {
    const glm::vec3 off =
        (node.bounds[c].lo * 0.125F + node.bounds[c].hi * 0.125F) - (whole.lo * 0.125F + whole.hi * 0.125F);
    return ((s & 1U) != 0 ? off.x : -off.x) + ((s & 2U) != 0 ? off.y : -off.y) + ((s & 4U) != 0 ? off.z : -off.z);
  };
  WideNode ordered;
  ordered.child.fill(empty_child);
  std::array<bool, wide> placed{}, taken{};
  for (std::uint32_t round = 0; round < wide; ++round) {  // greedy: the best of all pairs left
    std::uint32_t best_child = wide, best_slot = wide;
    float best = 0;
    for (std::uint32_t c = 0; c < wide; ++c) {
      if (placed[c] || node.child[c] == empty_child) continue;
      for (std::uint32_t s = 0; s < wide; ++s) {
        if (taken[s]) continue;
        const float g = gain(c, s);
        if (best_child != wide && !(g > best)) continue;
        best = g;
        best_child = c;
        best_slot = s;
      }
    }
    if (best_child == wide) break;
    placed[best_child] = taken[best_slot] = true;
    ordered.child[best_slot] = node.child[best_child];
    ordered.bounds[best_slot] = node.bounds[best_child];
  }
  node = ordered;
}

}  // namespace sheaf
