// SPDX-License-Identifier: MIT
#include "stages/rays_hierarchy.hpp"

#include "interface/push/trace.h"

namespace sheaf {

std::vector<HierarchyLevel> hierarchy_levels(std::uint32_t rays) {
  std::vector<HierarchyLevel> levels{{rays, 0}};
  std::uint32_t word = 0;
  while (levels.back().nodes > 1) {
    const std::uint32_t nodes = (levels.back().nodes + gpu::ARITY - 1) / gpu::ARITY;
    levels.push_back({nodes, word});
    word += nodes * gpu::RAY_NODE_WORDS;
  }
  return levels;
}

void RaysHierarchy::record(Recorder& recorder, const RayMemory& memory, std::uint32_t kind,
                           const std::vector<HierarchyLevel>& levels) const {
  recorder.stage("rays_hierarchy");
  recorder.bind(ROLE_RAY_NODES, memory.ray_nodes);
  for (std::uint32_t l = 1; l < levels.size(); ++l) {
    const gpu::RaysHierarchyPush push{kind, l, levels[l].first_word, levels[l - 1].first_word};
    recorder.dispatch(level_, push, (levels[l].nodes + gpu::GROUP - 1) / gpu::GROUP);
  }
}

}  // namespace sheaf
