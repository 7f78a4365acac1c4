// SPDX-License-Identifier: MIT
// Vertex attributes at a point of a triangle.
#ifndef SHEAF_ATTRIBUTES_GLSL
#define SHEAF_ATTRIBUTES_GLSL
#include "scene/memory.glsl"
#include "scene/scene.glsl"
#include "scene/textures.glsl"

struct ShadingInputs {
  Instance instance;
  Material material;
};

ShadingInputs shading_inputs_of(uint index) {
  Instance instance = load_instance(index);
  return ShadingInputs(instance, load_material(instance.material));
}

vec2 interpolate_uv(uint base, uvec3 v, vec3 b) {
  return base == NO_INDEX ? vec2(0) : load_uv(base + v.x) * b.x + load_uv(base + v.y) * b.y + load_uv(base + v.z) * b.z;
}

UvFootprint interpolate_uv_footprint(uint base, uvec3 v, vec3 b, vec2 along, vec2 across) {
  if (base == NO_INDEX) return UvFootprint(vec2(0), vec2(0), vec2(0));
  vec2 a = load_uv(base + v.x), e1 = load_uv(base + v.y), e2 = load_uv(base + v.z);
  vec2 at = a * b.x + e1 * b.y + e2 * b.z;
  e1 -= a;
  e2 -= a;
  return UvFootprint(at, e1 * along.x + e2 * along.y, e1 * across.x + e2 * across.y);
}

vec4 base_color_at(Instance instance, Material material, uvec3 v, vec3 b, vec4 texel) {
  vec4 color = material.base_color * texel;
  if (instance.color != NO_INDEX)
    color *= load_color(instance.color + v.x) * b.x + load_color(instance.color + v.y) * b.y +
             load_color(instance.color + v.z) * b.z;
  return color;
}

// An alpha-masked surface that is not there at this point.
bool masked_out(uint triangle, vec3 b) {
  ShadingInputs looks = shading_inputs_of(instance_of(load_triangle(triangle)));
  if ((looks.material.flags & MATERIAL_MASK) == 0u) return false;
  uvec3 v = triangle_vertices(looks.instance, triangle);
  vec2 uv0 = interpolate_uv(looks.instance.uv0, v, b), uv1 = interpolate_uv(looks.instance.uv1, v, b);
  vec4 texel = look_up(looks.instance.material, TEXTURE_BASE_COLOR, uv0, uv1);
  return base_color_at(looks.instance, looks.material, v, b, texel).a < looks.material.alpha_cutoff;
}
#endif
