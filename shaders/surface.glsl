// SPDX-License-Identifier: MIT
// Everything a hit needs to know about the surface there (SHADING.md, Geometry and Material).
#include "attributes.glsl"
BUFFER(ROLE_NORMALS, readonly, vec3, normals);
BUFFER(ROLE_TANGENTS, readonly, vec4, tangents);
BUFFER(ROLE_DYNAMIC, readonly, vec3, dynamic_vertices);  // three vec3 a vertex: position, normal, tangent (world)

layout(constant_id = 4) const bool TEXTURED_NORMALS = true;

struct Surface {
  vec3 point;
  vec3 point_error;   // bound of |computed − true| a coordinate, see offset_origin
  float reach;        // largest coordinate distance from the point to a corner of its triangle
  vec3 geometric;     // faces the ray
  vec3 normal;        // faces the ray
  bool front;
  vec4 base;
  float metallic;
  float roughness;
  vec3 emission;
  float occlusion;
  float transmission;
  vec2 uv;
  uint object;
  uint material;
};

vec3 transform_direction(Instance i, vec3 v) { return vec3(dot(i.row0, v), dot(i.row1, v), dot(i.row2, v)); }
vec3 transform_normal(Instance i, vec3 v) { return vec3(dot(i.normal0, v), dot(i.normal1, v), dot(i.normal2, v)); }

float max_of(vec3 v) { return max(max(v.x, v.y), v.z); }

vec3 safe_normalize(vec3 v, vec3 otherwise) {
  float size = length(v);
  return size > 0.0 && size < INFINITY ? v / size : otherwise;
}

vec3 shading_normal(Instance instance, Material material, uvec3 v, vec3 b, vec3 geometric, vec2 uv0, vec2 uv1) {
  bool is_dynamic = instance.dynamic != NO_INDEX;
  uvec3 d = 3u * (v + instance.dynamic);
  uvec3 s = v + instance.first_vertex;
  vec3 n = is_dynamic ? dynamic_vertices[d.x + 1u] * b.x + dynamic_vertices[d.y + 1u] * b.y + dynamic_vertices[d.z + 1u] * b.z
                      : transform_normal(instance, normals[s.x] * b.x + normals[s.y] * b.y + normals[s.z] * b.z);
  n = safe_normalize(n, geometric);
  if (!TEXTURED_NORMALS || material.normal_texture.texture == NO_INDEX || instance.tangent == NO_INDEX) return n;
  uvec3 w = v + instance.tangent;
  vec4 tangent = tangents[w.x] * b.x + tangents[w.y] * b.y + tangents[w.z] * b.z;
  vec3 t = is_dynamic ? dynamic_vertices[d.x + 2u] * b.x + dynamic_vertices[d.y + 2u] * b.y + dynamic_vertices[d.z + 2u] * b.z
                      : transform_direction(instance, tangent.xyz);
  t = safe_normalize(t, vec3(0));
  vec3 bitangent = cross(n, t) * (tangents[w.x].w < 0.0 ? -1.0 : 1.0) * instance.determinant_sign;
  vec3 texel = look_up(material.normal_texture, uv0, uv1, false).xyz * 2.0 - 1.0;
  float strength = material.normal_texture.strength;
  return safe_normalize(t * (texel.x * strength) + bitangent * (texel.y * strength) + n * texel.z, n);
}

Surface surface_at(uint triangle, vec3 b, vec3 direction) {
  Corners corners = load_triangle(triangle);
  Instance instance = instances[instance_of(corners)];
  Material material = materials[instance.material];
  uvec3 v = triangle_vertices(instance, triangle);
  vec3 v0 = corners.a, v1 = corners.b, v2 = corners.c;
  Surface s;
  precise vec3 point = v0 * b.x + v1 * b.y + v2 * b.z;
  s.point = point;
  // Three products and two sums, weights themselves off by 4 ulps: pbrt's γ7 (pbrt-v3 3.9.4), 7·2^-24/(1−7·2^-24).
  const float gamma7 = 4.172329e-7;
  s.point_error = gamma7 * (abs(v0 * b.x) + abs(v1 * b.y) + abs(v2 * b.z));
  s.reach = max_of(max(max(abs(v0 - point), abs(v1 - point)), abs(v2 - point)));
  vec3 g = safe_normalize(cross(v1 - v0, v2 - v0), -direction) * instance.determinant_sign;
  vec2 uv0 = interpolate_uv(instance.uv0, v, b), uv1 = interpolate_uv(instance.uv1, v, b);
  vec3 n = shading_normal(instance, material, v, b, g, uv0, uv1);
  s.front = dot(g, direction) < 0.0;
  s.geometric = s.front ? g : -g;
  s.normal = s.front ? n : -n;
  s.base = base_color_at(instance, material, v, b, uv0, uv1);
  vec4 mr = look_up(material.metallic_roughness_texture, uv0, uv1, false);
  s.metallic = clamp(material.metallic * mr.b, 0.0, 1.0);
  s.roughness = clamp(material.roughness * mr.g, 0.0, 1.0);
  s.emission = material.emissive * look_up(material.emissive_texture, uv0, uv1, true).rgb;
  s.occlusion = 1.0 + material.occlusion_texture.strength * (look_up(material.occlusion_texture, uv0, uv1, false).r - 1.0);
  s.transmission = clamp(material.transmission * look_up(material.transmission_texture, uv0, uv1, false).r, 0.0, 1.0);
  s.uv = uv0;
  s.object = instance.object;
  s.material = instance.material;
  return s;
}

float next_up(float v) { return uintBitsToFloat(v < 0.0 ? floatBitsToUint(v) - 1u : v == 0.0 ? 1u : floatBitsToUint(v) + 1u); }
float next_down(float v) { return -next_up(-v); }

// An origin on the side of `towards` that no rounding can put behind the surface: the error box of the point is pushed out
// along the normal and rounded away (pbrt-v3 3.9.5). The next test adds its own error: it works on corner − origin, up to
// `span` (the larger of the triangle's reach and the ray's length) a coordinate, each rounded once when subtracted, twice
// when sheared and twice when weighted, so a plane through the point may seem shifted by 5·2^-24·span an axis; 8 leaves room.
vec3 offset_origin(Surface s, vec3 towards, float length_of_ray) {
  float span = max(s.reach, length_of_ray);
  float distance = dot(abs(s.geometric), 2.0 * s.point_error + 4.7683716e-7 * span);
  vec3 offset = s.geometric * (dot(s.geometric, towards) < 0.0 ? -distance : distance);
  precise vec3 o = s.point + offset;
  o.x = offset.x > 0.0 ? next_up(o.x) : offset.x < 0.0 ? next_down(o.x) : o.x;
  o.y = offset.y > 0.0 ? next_up(o.y) : offset.y < 0.0 ? next_down(o.y) : o.y;
  o.z = offset.z > 0.0 ? next_up(o.z) : offset.z < 0.0 ? next_down(o.z) : o.z;
  return o;
}
