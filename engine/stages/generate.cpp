// SPDX-License-Identifier: MIT
#include "stages/generate.hpp"

#include <array>

#include "interface/push/shade.h"

namespace sheaf {

Generate::Generate(const Device& device, const Plan& plan, const Features& features, const RenderSettings& settings)
    : plan_(plan) {
  const std::array first{SpecConstant{SPEC_RASTER, plan.raster}, SpecConstant{SPEC_ADAPTIVE, plan.adaptive},
                         SpecConstant{SPEC_TEXTURED, features.textured}};
  primary_ = Kernel(device, "generate_primary", first);
  const SpecConstant one{SPEC_GROUP, 1};
  begin_ = Kernel(device, "generate_begin", {&one, 1});
  const std::array constants{
      SpecConstant{SPEC_SHADOWS, plan.shadows},
      SpecConstant{SPEC_REFLECTIONS, plan.reflections},
      SpecConstant{SPEC_REFRACTIONS, plan.refractions},
      SpecConstant{SPEC_TEXTURED_NORMALS, plan.textured_normals},
      SpecConstant{SPEC_VOLUMES, features.volumes},
      SpecConstant{SPEC_COUNTED, settings.counted},
      SpecConstant{SPEC_TEXTURED, features.textured},
      SpecConstant{SPEC_TRANSFORM_ON_FETCH, plan.transform_on_fetch},
      SpecConstant{SPEC_RASTER, plan.raster},
      SpecConstant{SPEC_LANES, device.limits().subgroup},
      SpecConstant{SPEC_TRANSLUCENT, features.transmissive},
      SpecConstant{SPEC_GLASS_ALPHA, settings.glass_alpha == GlassAlpha::transparent && features.transmissive},
      SpecConstant{SPEC_RANKED, features.coincident}};
  generate_ = Kernel(device, "generate", constants);
}

void Generate::primary(Recorder& recorder, const RayMemory& memory, std::uint32_t rays) const {
  recorder.stage("generate");
  memory.reflection[1].bind(recorder);
  if (memory.visibility) recorder.bind(ROLE_VISIBILITY, memory.visibility);
  if (memory.active_pixels) {
    recorder.bind(ROLE_ACTIVE_PIXELS, memory.active_pixels);
    recorder.bind(ROLE_SAMPLE_PLACES, memory.sample_places);
  }
  recorder.dispatch(primary_, gpu::NoPush{}, (rays + gpu::GROUP - 1) / gpu::GROUP);
}

void Generate::secondary(Recorder& recorder, const RayMemory& memory, const Parents& parents) const {
  recorder.stage("generate");
  const bool is_primary = parents.primary;
  const std::uint32_t from = parents.from, direct = parents.direct ? 1 : 0;
  const gpu::GenerateBeginPush begin{is_primary ? 1U : 0U, direct};
  recorder.dispatch(begin_, begin, 1);
  if (parents.direct) recorder.bind(ROLE_VISIBILITY, memory.visibility);
  const std::uint32_t to = 1 - from;
  recorder.bind_list(LIST_SHADOW_RAYS, memory.shadow.rays);
  if (plan_.reflections) recorder.bind_list(LIST_REFLECTION_RAYS, memory.reflection[is_primary ? 0 : to].rays);
  if (plan_.refractions) recorder.bind_list(LIST_REFRACTION_RAYS, memory.refraction[is_primary ? 0 : to].rays);
  gpu::GeneratePush push{is_primary ? gpu::KIND_PRIMARY : gpu::KIND_REFLECTION, direct, parents.sums};
  if (is_primary || plan_.reflections) {
    memory.reflection[is_primary ? 1 : from].bind(recorder);
    recorder.dispatch_indirect(generate_, push, gpu::ARGS_PARENTS);
  }
  if (!is_primary && plan_.refractions) {
    memory.refraction[from].bind(recorder);
    push.kind = gpu::KIND_REFRACTION;
    recorder.dispatch_indirect(generate_, push, gpu::ARGS_PARENTS_REFRACTION);
  }
}

}  // namespace sheaf
