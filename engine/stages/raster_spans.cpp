// SPDX-License-Identifier: MIT
#include "stages/raster_spans.hpp"

#include <array>
#include <cstdlib>
#include <string_view>

#include "interface/push/raster.h"

namespace sheaf {

RasterSpans::RasterSpans(const Device& device, const Plan& plan, const Features& features) {
  const std::array constants{SpecConstant{SPEC_MASKED, features.masked},
                             SpecConstant{SPEC_TEXTURED, features.textured},
                             SpecConstant{SPEC_LANES, device.limits().subgroup},
                             SpecConstant{SPEC_TRANSFORM_ON_FETCH, plan.transform_on_fetch},
                             SpecConstant{SPEC_ONE_SIDED, features.one_sided},
                             SpecConstant{SPEC_RANKED, features.coincident}};
  kernel_ = Kernel(device, "raster_spans", constants);
}

bool RasterSpans::pays(const Device& device) {
  if (const char* said = std::getenv("SHEAF_RASTER")) return std::string_view(said) == "spans";
  return device.limits().cpu;
}

void RasterSpans::record(Recorder& recorder, const Buffer& visibility, std::uint32_t triangles) const {
  constexpr std::uint32_t enough_groups = 64;  // for some cores to share evenly
  const std::uint32_t blocks = (triangles + gpu::GROUP - 1) / gpu::GROUP, bands = (enough_groups + blocks - 1) / blocks;
  const gpu::RasterSpansPush push{visibility.address_words(), bands};
  recorder.dispatch(kernel_, push, std::uint64_t{blocks} * bands);
}

}  // namespace sheaf
