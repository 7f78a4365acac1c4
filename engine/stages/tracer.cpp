// SPDX-License-Identifier: MIT
#include "stages/tracer.hpp"

#include <algorithm>

#include "core/error.hpp"
#include "stages/intersect_brute.hpp"
#include "stages/traverse_bundles.hpp"
#include "stages/traverse_classes.hpp"
#include "stages/traverse_frustums.hpp"
#include "stages/traverse_pairs.hpp"
#include "stages/traverse_query.hpp"
#include "stages/traverse_single.hpp"

namespace sheaf {

std::vector<SpecConstant> candidate_constants(const TraceContext& c, bool any_hit) {
  const bool translucent = c.features.translucent() || c.features.masked;
  return {{SPEC_ANY_HIT, any_hit},
          {SPEC_MASKED, c.features.masked},
          {SPEC_TRANSLUCENT, any_hit && translucent},
          {SPEC_ONE_SIDED, !any_hit && c.features.one_sided},
          {SPEC_RANKED, !any_hit && c.features.coincident},
          {SPEC_COUNTED, c.counted},
          {SPEC_PIXEL_COUNTED, c.settings.layers.tests},
          {SPEC_TEXTURED, c.features.textured},
          {SPEC_TRANSFORM_ON_FETCH, c.plan.transform_on_fetch}};
}

std::vector<SpecConstant> lane_constants(const Device& device, std::uint32_t rays) {
  const std::uint32_t lanes = std::min(device.limits().subgroup, rays);
  return {{SPEC_GROUP, lanes}, {SPEC_LANES, lanes}, {SPEC_VECTORS, rays / lanes}};
}

std::unique_ptr<Tracer> make_tracer(const TraceContext& context) {
  switch (context.strategy) {
    case Strategy::bvh:
      return std::make_unique<TraverseSingle>(context);
    case Strategy::hybrid:
      return std::make_unique<TraverseBundles>(context);
    case Strategy::rsh:
    case Strategy::crsh:
      return std::make_unique<TraversePairs>(context);
    case Strategy::frustum:
      return std::make_unique<TraverseFrustums>(context);
    case Strategy::classify:
      return std::make_unique<TraverseClasses>(context);
    case Strategy::brute:
      return std::make_unique<IntersectBrute>(context);
    case Strategy::rayquery:
      return std::make_unique<TraverseQuery>(context);
    default:
      break;
  }
  throw Error(ErrorKind::usage, std::string("strategy ") + name_of(context.strategy) + " has no tracer");
}

}  // namespace sheaf
