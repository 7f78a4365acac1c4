// SPDX-License-Identifier: MIT
// What all lanes of a subgroup want alike, as the hits of neighbouring rays mostly do, is read once, a pair of words a
// lane, and handed round: on a CPU device every load of a lane's own is a gather, and an instance and its material are
// thirty of them. Lanes that want another read theirs after that. All lanes are active; one without a hit stands in
// with another's.
#ifndef SHEAF_SHADING_INPUTS_GLSL
#define SHEAF_SHADING_INPUTS_GLSL
#include "lib/common.glsl"
#include "lib/convert.glsl"
#include "lib/frame.glsl"
#include "scene/attributes.glsl"
#include "scene/memory.glsl"
#include "lib/lanes.glsl"
const bool LOADS_BY_SUBGROUP = WORKERS > 0u && LANES >= 8u;

#define LOAD_SUBGROUP(pairs, count, buffer_at, offset) \
  { \
    uvec2 rows_[((count) + 7u) / 8u]; \
    [[unroll]] for (uint r_ = 0u; r_ < ((count) + 7u) / 8u; ++r_) \
      rows_[r_] = load_pair(buffer_at, offset, min(8u * r_ + (gl_SubgroupInvocationID & 7u), (count) - 1u)); \
    [[unroll]] for (uint k_ = 0u; k_ < (count); ++k_) pairs[k_] = subgroupBroadcast(rows_[k_ / 8u], k_ & 7u); \
  }

// Whether lanes go on that have nothing of their own to do.
bool continues(bool has) { return LOADS_BY_SUBGROUP ? any_lane(has) : has; }

// That of the first lane that has one, for those that have none.
uint value_or_first(uint value, bool has) {
  if (!LOADS_BY_SUBGROUP) return value;
  uint having = lanes_where(has), first = OF_LANE(value, lowest_bit(having | 1u << (LANES - 1u)));
  return has || having == 0u ? value : first;
}

struct SharedShadingInputs {
  ShadingInputs looks;
  uint material;  // that most lanes want; NO_INDEX: each reads its own
};

SharedShadingInputs shading_inputs_subgroup(uint index) {
  if (!LOADS_BY_SUBGROUP) return SharedShadingInputs(shading_inputs_of(index), NO_INDEX);
  uint shared_index = subgroupBroadcast(index, 0u);
  uvec2 i[INSTANCE_PAIRS], m[MATERIAL_PAIRS];
  LOAD_SUBGROUP(i, INSTANCE_PAIRS, frame.instances_at, instance_offset(shared_index));
  SharedShadingInputs s;
  s.looks.instance = unpack_instance(i);
  s.material = s.looks.instance.material;
  LOAD_SUBGROUP(m, MATERIAL_PAIRS, frame.materials_at, material_offset(s.material));
  s.looks.material = unpack_material(m);
  if (index != shared_index) s.looks = shading_inputs_of(index);
  return s;
}

TextureUse load_use_subgroup(SharedShadingInputs s, uint place) {
  if (!LOADS_BY_SUBGROUP) return load_use(s.looks.instance.material, place);
  uvec2 p[USE_PAIRS];
  LOAD_SUBGROUP(p, USE_PAIRS, frame.materials_at, use_offset(s.material, place));
  TextureUse use = unpack_use(p);
  if (s.looks.instance.material != s.material) use = load_use(s.looks.instance.material, place);
  return use;
}
#endif
