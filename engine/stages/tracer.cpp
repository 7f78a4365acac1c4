// SPDX-License-Identifier: MIT
#include "stages/tracer.hpp"

#include "core/error.hpp"
#include "stages/traverse_single.hpp"

namespace sheaf {

std::unique_ptr<Tracer> make_tracer(const TraceContext& context) {
  switch (context.strategy) {
    case Strategy::bvh: return std::make_unique<TraverseSingle>(context);
    default: break;
  }
  throw Error(ErrorKind::usage, std::string("strategy ") + name_of(context.strategy) + " has no tracer");
}

}  // namespace sheaf
