// SPDX-License-Identifier: MIT
// Everything a hit needs to know about the surface there (SHADING.md, Geometry and Material).
#ifndef SHEAF_SURFACE_GLSL
#define SHEAF_SURFACE_GLSL
#include "lib/common.glsl"
#include "scene/memory.glsl"
#include "scene/ranks.glsl"
#include "scene/scene.glsl"
#include "scene/attributes.glsl"
#include "lib/unit.glsl"
#include "shade/shading_inputs.glsl"

layout(constant_id = SPEC_TEXTURED_NORMALS) const bool TEXTURED_NORMALS = true;

struct Surface {
  vec3 point;
  vec3 point_error;   // bound of |computed − true| a coordinate, see offset_origin
  float reach;        // largest coordinate distance from the point to a corner of its triangle
  vec3 geometric;     // faces the ray
  vec3 normal;        // faces the ray
  vec3 vertex_normal; // the same without a normal map
  float lift;         // along it, onto a level with the triangle's highest corner; 0 where the triangle is flat
  bool front;
  uint rank;          // among what lies in the same place (ranks.glsl), as the ray met it; 0: alone
  uint rank_behind;   // as a ray meets it that comes back
  vec4 base;
  float metallic;
  float roughness;
  vec3 emission;
  float occlusion;
  float transmission;
  vec2 uv;
  float curvature;    // of the shading normal towards the ray's side: > 0 where it bulges; 0 without textures
  uint object;
};

vec3 transform_direction(Instance i, vec3 v) { return vec3(dot(i.row0, v), dot(i.row1, v), dot(i.row2, v)); }
vec3 transform_normal(Instance i, vec3 v) { return vec3(dot(i.normal0, v), dot(i.normal1, v), dot(i.normal2, v)); }

const float MAX_SPREAD = 1e3;  // of a ray's cone: past it nothing has detail left

// `side`: front_sign.
vec3 shading_normal(Instance instance, float side, uvec3 v, vec3 b, vec3 geometric, TextureUse use, vec3 mapped,
                    out vec3 vertex_normal) {
  bool is_dynamic = instance.dynamic != NO_INDEX;
  uvec3 d = 3u * (v + instance.dynamic);
  uvec3 s = v + instance.first_vertex;
  vec3 n = is_dynamic
               ? load_dynamic(d.x + 1u) * b.x + load_dynamic(d.y + 1u) * b.y + load_dynamic(d.z + 1u) * b.z
               : transform_normal(instance, load_normal(s.x) * b.x + load_normal(s.y) * b.y + load_normal(s.z) * b.z);
  n = safe_normalize(n, geometric);
  vertex_normal = n;
  if (!TEXTURED_NORMALS || instance.tangent == NO_INDEX) return n;
  if ((use.flags & TEXTURE_HERE) == 0u) return n;
  uvec3 w = v + instance.tangent;
  vec4 first_tangent = load_tangent(w.x);
  vec4 tangent = first_tangent * b.x + load_tangent(w.y) * b.y + load_tangent(w.z) * b.z;
  vec3 t = is_dynamic ? load_dynamic(d.x + 2u) * b.x + load_dynamic(d.y + 2u) * b.y + load_dynamic(d.z + 2u) * b.z
                      : transform_direction(instance, tangent.xyz);
  t = safe_normalize(t, vec3(0));
  vec3 bitangent = cross(n, t) * (first_tangent.w < 0.0 ? -1.0 : 1.0) * side;
  vec3 texel = mapped * 2.0 - 1.0;
  return safe_normalize(t * (texel.x * use.strength) + bitangent * (texel.y * use.strength) + n * texel.z, n);
}

// The ellipse in which a cone of width 1 meets the surface, as two diameters: in the plane of incidence and across it
// (Akenine-Möller et al., "Improved Shader and Texture Level of Detail Using Ray Cones", JCGT 2021).
void footprint_axes(vec3 normal, vec3 direction, out vec3 along, out vec3 across) {
  float cosine = dot(normal, direction);
  vec3 level = direction - cosine * normal;
  vec3 any = abs(normal.x) < 0.6 ? vec3(1, 0, 0) : vec3(0, 1, 0);
  along = dot(level, level) > 1e-12 ? normalize(level) : normalize(cross(normal, any));
  across = cross(normal, along);
  along /= max(abs(cosine), 1e-3);
}

struct Slopes {  // what a step in the triangle's plane adds to the weights of v1 and v2
  vec2 along, across;
};

Slopes slopes_of(vec3 e1, vec3 e2, vec3 along, vec3 across) {
  float scale = inverse_scale(max_of(max(abs(e1), abs(e2))));
  e1 *= scale;
  e2 *= scale;
  vec3 n = cross(e1, e2);
  float area = length(n);
  vec3 unit = n / area;
  Slopes s = Slopes(vec2(dot(cross(along, e2), unit), dot(cross(e1, along), unit)) / area * scale,
                    vec2(dot(cross(across, e2), unit), dot(cross(e1, across), unit)) / area * scale);
  return area > 0.0 ? s : Slopes(vec2(0), vec2(0));
}

// The mean of the normal curvatures along both axes: how much the interpolated normal turns towards a step, a unit of
// the step.
float curvature_of(Instance instance, uvec3 v, vec3 b, Slopes s, vec3 along, vec3 across) {
  vec3 n0, n1, n2;
  if (instance.dynamic != NO_INDEX) {
    uvec3 d = 3u * (v + instance.dynamic) + 1u;
    n0 = load_dynamic(d.x), n1 = load_dynamic(d.y), n2 = load_dynamic(d.z);
  } else {
    uvec3 w = v + instance.first_vertex;
    n0 = transform_normal(instance, load_normal(w.x));
    n1 = transform_normal(instance, load_normal(w.y));
    n2 = transform_normal(instance, load_normal(w.z));
  }
  float size = length(n0 * b.x + n1 * b.y + n2 * b.z);
  vec3 d1 = n1 - n0, d2 = n2 - n0;
  float turns = dot(d1 * s.along.x + d2 * s.along.y, along) / dot(along, along) +
                dot(d1 * s.across.x + d2 * s.across.y, across) / dot(across, across);
  float curvature = 0.5 * turns / size;
  return abs(curvature) < INFINITY ? curvature : 0.0;  // false for a NaN: no normal
}

// All of a material's textures, each its mean over the footprint, and how the normals' and the occlusion's are used.
struct Texels {
  vec4 of[TEXTURES];
  TextureUse normal, occlusion;
};

Texels look_up_filtered(SharedShadingInputs looks, TexturePoint p) {
  Texels texels;
  for (uint k = 0u; k < TEXTURES; ++k) texels.of[k] = vec4(1);
  texels.normal.flags = 0u;
  texels.occlusion.strength = 0.0;
  if (!TEXTURED) return texels;
  [[dont_unroll]] for (uint k = 0u; k < TEXTURES; ++k) {
    TextureUse use = load_use_subgroup(looks, k);
    if (k == TEXTURE_NORMAL) texels.normal = use;
    if (k == TEXTURE_OCCLUSION) texels.occlusion = use;
    if ((use.flags & TEXTURE_HERE) == 0u) continue;
    UvFootprint f = p.uv0;
    if ((use.flags & TEXTURE_UV1) != 0u) f = p.uv1;
    f = UvFootprint(turn_uv(use, f.at) + use.offset, turn_uv(use, f.along), turn_uv(use, f.across));
    vec4 texel = sample_filtered(use, f, is_color(k));
    [[unroll]] for (uint at = 0u; at < TEXTURES; ++at) texels.of[at] = at == k ? texel : texels.of[at];
  }
  return texels;
}

// How far the triangle's highest corner is above the point, as the vertex normals see it: no ray from there on goes
// back through the triangle if it goes up (SHADING.md, Shadow rays). Less than 10^-5 of the triangle's size is
// rounding: it is flat.
float lift_of(Surface s, vec3 v0, vec3 v1, vec3 v2) {
  float lift = max_of(
      vec3(dot(v0 - s.point, s.vertex_normal), dot(v1 - s.point, s.vertex_normal), dot(v2 - s.point, s.vertex_normal)));
  return lift > 1e-5 * s.reach && dot(s.vertex_normal, s.geometric) > 0.0 ? lift : 0.0;
}

void set_ranks(uint word, bool clockwise, inout Surface s) {
  s.rank = s.rank_behind = 0u;
  if (!RANKED) return;
  s.rank = rank_of(word, clockwise);
  // What does not turn was met in this order and no other: nothing of the place is seen from there once more.
  s.rank_behind = s.rank == 0u ? 0u : (word & TRIANGLE_TURNS) != 0u ? LAST_RANK + 1u - s.rank : LAST_RANK;
}

// All lanes are active (shading_inputs.glsl).
Surface surface_at(uint triangle, vec3 b, vec3 direction, float width, out Material material) {
  Corners corners = load_triangle(triangle);
  SharedShadingInputs looks = shading_inputs_subgroup(instance_of(corners));
  Instance instance = looks.looks.instance;
  material = looks.looks.material;
  uvec3 v = triangle_vertices(instance, triangle);
  vec3 v0 = corners.a, v1 = corners.b, v2 = corners.c;
  Surface s;
  precise vec3 point = v0 * b.x + v1 * b.y + v2 * b.z;
  s.point = point;
  // Three products and two sums, weights themselves off by 4 ulps: pbrt's γ7 (pbrt-v3 3.9.4), 7·2^-24/(1−7·2^-24).
  const float gamma7 = 4.172329e-7;
  s.point_error = gamma7 * (abs(v0 * b.x) + abs(v1 * b.y) + abs(v2 * b.z));
  s.reach = max_of(max(max(abs(v0 - point), abs(v1 - point)), abs(v2 - point)));
  float side = front_sign(corners);
  vec3 g = triangle_normal(v0, v1, v2, -direction) * side;
  TexturePoint point_uv;
  s.curvature = 0.0;
  if (TEXTURED) {
    vec3 along, across;
    footprint_axes(g, direction, along, across);
    Slopes slopes = slopes_of(v1 - v0, v2 - v0, along, across);
    point_uv = TexturePoint(
        interpolate_uv_footprint(instance.uv0, v, b, slopes.along * abs(width), slopes.across * abs(width)),
        interpolate_uv_footprint(instance.uv1, v, b, slopes.along * abs(width), slopes.across * abs(width)));
    if (width != 0.0) s.curvature = curvature_of(instance, v, b, slopes, along, across);
  }
  Texels texels = look_up_filtered(looks, point_uv);
  vec3 n = shading_normal(instance, side, v, b, g, texels.normal, texels.of[TEXTURE_NORMAL].xyz, s.vertex_normal);
  s.front = dot(g, direction) < 0.0;
  if (!s.front) s.curvature = -s.curvature;
  s.geometric = s.front ? g : -g;
  s.normal = s.front ? n : -n;
  s.vertex_normal = s.front ? s.vertex_normal : -s.vertex_normal;
  s.lift = lift_of(s, v0, v1, v2);
  s.base = base_color_at(instance, material, v, b, texels.of[TEXTURE_BASE_COLOR]);
  vec4 mr = texels.of[TEXTURE_METALLIC_ROUGHNESS];
  s.metallic = clamp(material.metallic * mr.b, 0.0, 1.0);
  s.roughness = clamp(material.roughness * mr.g, 0.0, 1.0);
  s.emission = material.emissive * texels.of[TEXTURE_EMISSIVE].rgb;
  s.occlusion = 1.0;
  if (TEXTURED) s.occlusion += texels.occlusion.strength * (texels.of[TEXTURE_OCCLUSION].r - 1.0);
  s.transmission = clamp(material.transmission * texels.of[TEXTURE_TRANSMISSION].r, 0.0, 1.0);
  s.uv = TEXTURED ? point_uv.uv0.at : interpolate_uv(instance.uv0, v, b);
  s.object = instance.object;
  return s;
}

float next_up(float v) {
  return uintBitsToFloat(v < 0.0 ? floatBitsToUint(v) - 1u : v == 0.0 ? 1u : floatBitsToUint(v) + 1u);
}
float next_down(float v) { return -next_up(-v); }

// An origin on the side of `towards` that no rounding can put behind the surface: the error box of the point is pushed
// out along the normal and rounded away (pbrt-v3 3.9.5). The next test adds its own error: it works on corner − origin,
// up to `span` (the larger of the triangle's reach and the ray's length) a coordinate, each rounded once when
// subtracted, twice when sheared and twice when weighted, so a plane through the point may seem shifted by 5·2^-24·span
// an axis; 8 leaves room.
//
// Where other surfaces lie in the same place, theirs is the larger error: a step of ranks.
vec3 offset_origin(Surface s, vec3 towards, float length_of_ray) {
  float span = max(s.reach, length_of_ray);
  float distance = dot(abs(s.geometric), 2.0 * s.point_error + 4.7683716e-7 * span);
  if (RANKED && s.rank != 0u) distance = max(distance, step_across(sum_of(s.point)));
  vec3 offset = s.geometric * (dot(s.geometric, towards) < 0.0 ? -distance : distance);
  precise vec3 o = s.point + offset;
  o.x = offset.x > 0.0 ? next_up(o.x) : offset.x < 0.0 ? next_down(o.x) : o.x;
  o.y = offset.y > 0.0 ? next_up(o.y) : offset.y < 0.0 ? next_down(o.y) : o.y;
  o.z = offset.z > 0.0 ? next_up(o.z) : offset.z < 0.0 ? next_down(o.z) : o.z;
  return o;
}

// Where a ray goes on from a surface. If others lie in the same place it starts in that place itself, half a step
// behind the surface of that rank (seen_corners): it meets those that come after, and none of those before.
void start_ray(Surface s, vec3 towards, vec3 direction, uint rank, out vec3 origin, out float tmin) {
  tmin = 0.0;
  if (!RANKED || s.rank == 0u) {
    origin = offset_origin(s, towards, 0.0);
    return;
  }
  origin = s.point;
  float steep = min(1.0 / abs(dot(s.geometric, direction)), STEEPEST);
  tmin = -(float(rank) + 0.5) * step_across(sum_of(s.point)) * steep;
}
#endif
