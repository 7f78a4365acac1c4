// SPDX-License-Identifier: MIT
#include "stages/tracer.hpp"

#include "core/error.hpp"
#include "stages/intersect_brute.hpp"
#include "stages/traverse_bundles.hpp"
#include "stages/traverse_pairs.hpp"
#include "stages/traverse_query.hpp"
#include "stages/traverse_single.hpp"

namespace sheaf {

std::unique_ptr<Tracer> make_tracer(const TraceContext& context) {
  switch (context.strategy) {
    case Strategy::bvh:
      return std::make_unique<TraverseSingle>(context);
    case Strategy::hybrid:
      return std::make_unique<TraverseBundles>(context);
    case Strategy::rsh:
    case Strategy::crsh:
      return std::make_unique<TraversePairs>(context);
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
