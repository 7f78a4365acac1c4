// SPDX-License-Identifier: MIT
#include "stages/layers.hpp"

#include <array>
#include <bit>

#include "interface/push/push.h"

namespace sheaf {

Layers::Layers(const Device& device, const Plan& plan, const Features& features) {
  const std::array constants{SpecConstant{SPEC_TEXTURED_NORMALS, plan.textured_normals},
                             SpecConstant{SPEC_TEXTURED, features.textured},
                             SpecConstant{SPEC_TRANSFORM_ON_FETCH, plan.transform_on_fetch},
                             SpecConstant{SPEC_LANES, device.limits().subgroup}};
  layers_ = Kernel(device, "layers", constants);
}

void Layers::record(Recorder& recorder, const RayMemory& memory, std::uint32_t pixels) const {
  recorder.stage("generate");
  memory.reflection[1].bind(recorder);
  recorder.bind(ROLE_LAYERS, memory.layers);
  recorder.dispatch(layers_, gpu::NoPush{}, (pixels + gpu::GROUP - 1) / gpu::GROUP);
  recorder.copy(memory.layers, memory.layers_readback, std::uint64_t{pixels} * gpu::LAYER_WORDS * 4);
}

void allocate_layers(const LayerSet& wanted, FrameLayers& layers) {
  const std::size_t pixels = std::size_t{layers.width} * layers.height;
  layers.rgba.resize(pixels * 4);
  if (wanted.depth) layers.depth.resize(pixels);
  if (wanted.normal) layers.normal.resize(pixels * 3);
  if (wanted.position) layers.position.resize(pixels * 3);
  if (wanted.albedo) layers.albedo.resize(pixels * 3);
  if (wanted.uv) layers.uv.resize(pixels * 2);
  if (wanted.id) {
    layers.object_id.resize(pixels);
    layers.material_id.resize(pixels);
  }
  if (wanted.tests) layers.tests.resize(pixels);
}

void Layers::store(const RayMemory& memory, const Tile& tile, const glm::dvec3& origin, float z_background,
                   FrameLayers& out) {
  const auto words = memory.layers_readback.view<float>();
  const std::size_t pixels = tile.pixels();
  auto spread = [&](std::vector<float>& to, std::uint32_t first, std::uint32_t channels, std::size_t from,
                    std::size_t at) {
    if (to.empty()) return;
    for (std::uint32_t c = 0; c < channels; ++c) to[at * channels + c] = words[(first + c) * pixels + from];
  };
  for (std::uint32_t y = 0; y < tile.height; ++y)
    for (std::uint32_t x = 0; x < tile.width; ++x) {
      const std::size_t from = std::size_t{y} * tile.width + x;
      const std::size_t at = std::size_t{tile.y + y} * out.width + tile.x + x;
      spread(out.depth, gpu::LAYER_DEPTH, 1, from, at);
      spread(out.normal, gpu::LAYER_NORMAL, 3, from, at);
      spread(out.albedo, gpu::LAYER_ALBEDO, 3, from, at);
      spread(out.uv, gpu::LAYER_UV, 2, from, at);
      const auto object = std::bit_cast<std::uint32_t>(words[gpu::LAYER_OBJECT * pixels + from]);
      if (!out.depth.empty() && object == 0) out.depth[at] = z_background;
      if (!out.position.empty() && object != 0)
        for (std::uint32_t c = 0; c < 3; ++c)
          out.position[at * 3 + c] =
              static_cast<float>(words[(gpu::LAYER_POSITION + c) * pixels + from] + origin[static_cast<int>(c)]);
      if (out.object_id.empty()) continue;
      out.object_id[at] = object;
      out.material_id[at] = std::bit_cast<std::uint32_t>(words[gpu::LAYER_MATERIAL * pixels + from]);
    }
}

}  // namespace sheaf
