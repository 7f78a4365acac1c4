// SPDX-License-Identifier: MIT
// Vertex attributes at a point of a triangle.
#include "textures.glsl"
BUFFER(ROLE_INDICES, readonly, uint, indices);
BUFFER(ROLE_UVS, readonly, vec2, uvs);
BUFFER(ROLE_COLORS, readonly, vec4, colors);

uvec3 triangle_vertices(Instance instance, uint triangle) {
  uint first = instance.first_index + 3u * (triangle - instance.first_triangle);
  return uvec3(indices[first], indices[first + 1u], indices[first + 2u]);
}

vec2 interpolate_uv(uint base, uvec3 v, vec3 b) {
  return base == NO_INDEX ? vec2(0) : uvs[base + v.x] * b.x + uvs[base + v.y] * b.y + uvs[base + v.z] * b.z;
}

vec4 base_color_at(Instance instance, Material material, uvec3 v, vec3 b, vec2 uv0, vec2 uv1) {
  vec4 color = material.base_color * look_up(material.base_color_texture, uv0, uv1, true);
  if (instance.color != NO_INDEX)
    color *= colors[instance.color + v.x] * b.x + colors[instance.color + v.y] * b.y + colors[instance.color + v.z] * b.z;
  return color;
}

// Base color with alpha at a candidate hit, before it is known to count.
vec4 candidate_color(uint triangle, vec3 b) {
  Instance instance = instances[instance_of(load_triangle(triangle))];
  uvec3 v = triangle_vertices(instance, triangle);
  return base_color_at(instance, materials[instance.material], v, b, interpolate_uv(instance.uv0, v, b),
                       interpolate_uv(instance.uv1, v, b));
}

// An alpha-masked surface that is not there at this point.
bool masked_out(uint triangle, vec3 b) {
  Material material = materials[instances[instance_of(load_triangle(triangle))].material];
  return (material.flags & MATERIAL_MASK) != 0u && candidate_color(triangle, b).a < material.alpha_cutoff;
}
