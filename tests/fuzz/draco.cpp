// SPDX-License-Identifier: MIT
// Draco's meshes. The first byte says how many components the attributes 0 to 3 are asked for, and of what type.
#include "scene/draco_mesh.hpp"
#include "target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sheaf;
  if (size == 0) return 0;
  static constexpr int types[] = {5120, 5121, 5122, 5123, 5125, 5126, 5126, 5126};
  std::vector<DracoAttribute> wanted;
  for (std::uint32_t id = 0; id < (data[0] >> 5) % 4u; ++id)
    wanted.push_back({id, types[data[0] & 7], (data[0] >> 3 & 3) + 1});
  const DracoMesh mesh = decode_draco({data + 1, size - 1}, wanted, {200'000, 200'000, 8 << 20});
  if (!mesh.fault.empty()) return 0;
  fuzz::require(mesh.indices.size() % 3 == 0 && mesh.attributes.size() == wanted.size(), "what was asked for is there");
  for (const auto& values : mesh.attributes)
    fuzz::require(values.size() % (mesh.vertices == 0 ? 1 : mesh.vertices) == 0, "every vertex has its values");
  return 0;
}
