// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// Shades the hits of one list of rays and makes the rays that follow from them: shadow rays (turned round, from the
// light), reflection and refraction (SHADING.md, "What a hit adds"). Parent i writes reflection and refraction slot
// base + i and shadow slots (base + i) + light · parents; a slot without a ray is marked, and compaction drops it.
#define COMPUTE
#include "lib/common.glsl"
#include "interface/shading.h"
#include "interface/push/shade.h"
#include "lib/push.glsl"
#include "lists/rays.glsl"
#include "scene/scene.glsl"
#include "shade/surface.glsl"
#include "scene/fresnel.glsl"
#include "shade/lobes.glsl"
#include "shade/media.glsl"
#include "shade/accumulate.glsl"
#include "lib/counters.glsl"
#include "lib/counting.glsl"

layout(constant_id = SPEC_SHADOWS) const bool SHADOWS = true;
layout(constant_id = SPEC_REFLECTIONS) const bool REFLECTIONS = true;
layout(constant_id = SPEC_REFRACTIONS) const bool REFRACTIONS = true;
layout(constant_id = SPEC_VOLUMES) const bool VOLUMES = true;
layout(constant_id = SPEC_TRANSLUCENT) const bool TRANSLUCENT = true;    // some surface has T > 0
// What is seen through such surfaces is not covered.
layout(constant_id = SPEC_GLASS_ALPHA) const bool GLASS_ALPHA = false;

PUSH(GeneratePush);

#include "shade/parents.glsl"

// All lanes are active.
Light load_light_subgroup(uint index) {
  uvec2 p[LIGHT_PAIRS];
  if (LOADS_BY_SUBGROUP) {
    LOAD_SUBGROUP(p, LIGHT_PAIRS, frame.lights_at, 8u * LIGHT_PAIRS * index);
  } else {
    LOAD_PAIRS(p, LIGHT_PAIRS, frame.lights_at, 8u * LIGHT_PAIRS * index);
  }
  vec4 place = floats(p[0], p[1]), way = floats(p[2], p[3]), shine = floats(p[4], p[5]);
  return Light(place.xyz, floatBitsToUint(place.w), way.xyz, way.w, shine.xyz, shine.w, floats(p[6]).x, 0u);
}

float mean_of(vec3 v) { return (v.r + v.g + v.b) / 3.0; }
float largest(vec3 v) { return max(max(v.x, v.y), v.z); }

bool worth_a_ray(float weight) { return weight > 0.0 && weight >= frame.cutoff; }

// Bounces, and blended surfaces gone straight through.
bool may_bounce(Parent p) { return (p.past & 0xFFFFu) < frame.depth; }
const uint ONE_BOUNCE = 1u, ONE_BLENDED = 1u << 16;

uint volume_material(uint volume) {  // volumes are numbered at load; their materials come first in the buffer
  return volume - 1u;
}

vec3 light_arriving(Light light, vec3 point, out vec3 towards, out float distance) {
  vec3 l = light.radiance;
  if (light.kind == LIGHT_DIRECTIONAL) {
    towards = -light.direction;
    distance = INFINITY;
    return min(l, vec3(1e9));
  }
  vec3 away = light.position - point;
  distance = length(away);
  towards = distance > 0.0 ? away / distance : vec3(0);
  float fade = 1.0;
  if (light.range < INFINITY) {
    float q = distance / light.range;
    fade = clamp(1.0 - q * q * q * q, 0.0, 1.0);
  }
  if (light.kind == LIGHT_SPOT) {
    float cone = clamp(dot(-towards, light.direction) * light.spot_scale + light.spot_offset, 0.0, 1.0);
    fade *= cone * cone;
  }
  return min(l * (fade / max(distance * distance, 1e-30)), vec3(1e9));
}

void no_ray_shadow(uint slot) { store_no_ray(ray_list.shadow_rays, slot); }
void no_ray_reflection(uint slot) {
  if (REFLECTIONS) store_no_ray(ray_list.reflection_rays, slot);
}
void no_ray_refraction(uint slot) {
  if (REFRACTIONS) store_no_ray(ray_list.refraction_rays, slot);
}

void make_shadow_ray(uint slot, Light light, uint index, Surface s, vec3 weight, Lobes lobes, vec3 v, uint pixel) {
  vec3 l;
  float distance;
  vec3 arriving = light_arriving(light, s.point, l, distance);
  vec3 carried = vec3(0);
  bool faces = dot(s.geometric, l) > 0.0;
  bool lifted = !faces && s.lift > 0.0 && dot(s.vertex_normal, l) > 0.0;
  if (dot(s.normal, l) > 0.0 && (faces || lifted)) carried = weight * reflectance(s, lobes, v, l) * arriving;
  if (!(largest(carried) > 0.0)) {
    no_ray_shadow(slot);
    return;
  }
  if (lifted) s.point += s.lift * s.vertex_normal;
  vec3 target = offset_origin(s, lifted ? s.geometric : l, light.kind == LIGHT_DIRECTIONAL ? 0.0 : distance);
  vec3 origin = light.position, direction = target - light.position;
  // SHADING.md, Lights: a lamp's own surface does not hide it.
  float tmin = 0.25 * frame.box_pad, tmax = length(direction);
  if (light.kind == LIGHT_DIRECTIONAL) {
    origin = target;
    direction = l;
    tmin = 0.0;
    tmax = INFINITY;
  } else {
    direction = tmax > 0.0 ? direction / tmax : -l;
  }
  store_ray(ray_list.shadow_rays, slot, Ray(origin, direction, tmin, tmax), pixel, RayPayload(carried, 0.0, index, 0u));
}

// What a hit leaves of its parent's cone (SHADING.md, Texture filter). `bending`: what a unit of the surface's
// curvature, times the cone's width there, adds to the spread; `scaling`: what becomes of the spread itself.
vec2 cone_after(Parent p, Surface s, float t, float scaling, float bending) {
  float width = clamp(p.cone_width + p.cone_spread * t, -1e30, 1e30);
  return vec2(width, clamp(scaling * p.cone_spread + bending * s.curvature * width, -MAX_SPREAD, MAX_SPREAD));
}

void make_reflection_ray(uint slot, Surface s, float t, vec3 weight, Parent p) {
  if (!may_bounce(p) || !worth_a_ray(largest(weight))) {
    no_ray_reflection(slot);
    return;
  }
  vec3 d = reflect(p.ray.direction, s.normal);
  if (!(dot(d, s.geometric) > 0.0)) d = reflect(p.ray.direction, s.geometric);
  d = safe_normalize(d, s.geometric);
  vec3 o;
  float tmin;
  start_ray(s, s.geometric, d, s.rank_behind, o, tmin);
  store_ray(ray_list.reflection_rays, slot, Ray(o, d, tmin, INFINITY), p.pixel,
            RayPayload(weight, 0.0, p.medium, p.past + ONE_BOUNCE));
  if (TEXTURED) store_ray_cone(ray_list.reflection_rays, slot, cone_after(p, s, t, 1.0, 2.0));
}

// Through the surface; `carried.past` counts this too.
void store_ray_through(uint slot, Surface s, vec3 direction, RayPayload carried, uint pixel, vec2 cone) {
  vec3 o;
  float tmin;
  start_ray(s, -s.geometric, direction, s.rank, o, tmin);
  store_ray(ray_list.refraction_rays, slot, Ray(o, direction, tmin, INFINITY), pixel, carried);
  if (TEXTURED) store_ray_cone(ray_list.refraction_rays, slot, cone);
}

bool make_refraction_ray(uint slot, Surface s, vec3 direction, vec3 weight, uint medium, float coverage, Parent p,
                         vec2 cone) {
  bool made = may_bounce(p) && worth_a_ray(max(largest(weight), coverage));
  if (made)
    store_ray_through(slot, s, direction, RayPayload(weight, coverage, medium, p.past + ONE_BOUNCE), p.pixel, cone);
  else
    no_ray_refraction(slot);
  return made;
}

// Straight through a blended surface: no bounce, but there is a bound.
void make_straight_ray(uint slot, Surface s, float alpha, float t, Parent p) {
  vec3 weight = p.weight * (1.0 - alpha);
  float coverage = p.coverage * (1.0 - alpha);
  bool worth = worth_a_ray(max(largest(weight), coverage)), stopped = (p.past >> 16) >= MOST_BLENDED;
  if (!worth || stopped) {
    if (worth) atomicAdd(stats[KIND_REFRACTION * STAT_FIELDS + STAT_STOPPED], 1ul);
    no_ray_refraction(slot);
    return;
  }
  store_ray_through(slot, s, p.ray.direction, RayPayload(weight, coverage, p.medium, p.past + ONE_BLENDED), p.pixel,
                    cone_after(p, s, t, 1.0, 0.0));
}

float ior_of(uint stack) { return (stack & 0xFFu) == 0u ? 1.0 : load_material(volume_material(stack & 0xFFu)).ior; }

// Snell about n; false in total internal reflection.
bool bend(vec3 d, vec3 n, float eta, out vec3 t) {
  float c = -dot(d, n);
  float k = 1.0 - eta * eta * (1.0 - c * c);
  t = eta * d + (eta * c - sqrt(max(k, 0.0))) * n;
  return k > 0.0;
}

// Step 7: the lobes of a surface that lets light through.
void see_through(Surface s, Material m, Parent p, float nv, inout Lobes lobes, out Interface face) {
  face.n1 = 1.0;
  face.n2 = m.ior;
  face.medium = p.medium;
  if (VOLUMES && m.volume != 0u) {
    face.medium = s.front ? media_push(p.medium, m.volume) : media_remove(p.medium, m.volume);
    face.n1 = s.front ? ior_of(p.medium) : m.ior;
    if (!s.front) face.n2 = ior_of(face.medium);
  }
  face.normal = s.normal;
  face.cosine = -dot(p.ray.direction, s.normal);
  if (!(face.cosine > 0.0)) {
    face.normal = s.geometric;
    face.cosine = clamp(-dot(p.ray.direction, s.geometric), 0.0, 1.0);
  }
  lobes.dielectric = fresnel(min(face.cosine, 1.0), face.n1, face.n2);
  lobes.mirrored = mix(vec3(lobes.dielectric), schlick(s.base.rgb, nv), s.metallic);
  lobes.share = mix(lobes.share, 1.0, s.transmission);
}

// Step 9. Gives what the ray takes along of the parent's coverage `cover`.
float make_transmitted_ray(uint slot, Surface s, Material m, float t, vec3 weight, float cover, Parent p, Lobes lobes,
                           Interface face) {
  vec3 share = (s.transmission * (1.0 - s.metallic) * (1.0 - lobes.dielectric)) * s.base.rgb;
  vec3 way = p.ray.direction;
  bool passes = lobes.dielectric < 1.0;
  vec2 cone = cone_after(p, s, t, 1.0, 0.0);
  if (VOLUMES && m.volume != 0u && passes) {
    float eta = face.n1 / face.n2;
    passes = bend(p.ray.direction, face.normal, eta, way);
    if (passes && dot(way, s.geometric) >= 0.0) passes = bend(p.ray.direction, s.geometric, eta, way);
    way = safe_normalize(way, p.ray.direction);
    cone = cone_after(p, s, t, eta, eta * face.cosine + dot(way, face.normal));
  }
  float coverage = GLASS_ALPHA ? cover * min(mean_of(share), 1.0) : 0.0;
  bool made = make_refraction_ray(slot, s, way, passes ? weight * share : vec3(-1), face.medium,
                                  passes ? coverage : -1.0, p, cone);
  return made ? coverage : 0.0;
}

vec3 absorbed(Parent p, Surface s, Material m, float t) {
  uint top = p.medium & 0xFFu;
  vec3 absorption = vec3(0);
  if (top != 0u)
    absorption = load_material(volume_material(top)).absorption;
  else if (m.volume != 0u && !s.front)
    absorption = m.absorption;
  return vec3(absorption.x > 0.0 ? exp2(-absorption.x * t) : 1.0, absorption.y > 0.0 ? exp2(-absorption.y * t) : 1.0,
              absorption.z > 0.0 ? exp2(-absorption.z * t) : 1.0);
}

void add_own(uint pixel, vec3 light, float coverage) {
  if (push.sums != SUMS_SHARED)
    add_alone(pixel, fixed_point(vec4(light, coverage)), 4u, push.sums == SUMS_UNSET);
  else
    accumulate(pixel, fixed_point(vec4(light, coverage)), 4u);
}

// The rays that go on from a surface, light's aside. Gives what one through glass takes along of the parent's coverage.
float make_secondary_rays(uint slot, Surface s, Material m, float t, vec3 weight, float alpha, Parent p, Lobes lobes,
                          Interface face) {
  if (REFLECTIONS && (m.flags & MATERIAL_UNLIT) == 0u)
    make_reflection_ray(slot, s, t, weight * (lobes.share * lobes.mirrored), p);
  else
    no_ray_reflection(slot);
  if (REFRACTIONS && TRANSLUCENT && s.transmission > 0.0)
    return make_transmitted_ray(slot, s, m, t, weight, p.coverage, p, lobes, face);
  if (REFRACTIONS && alpha < 1.0)
    make_straight_ray(slot, s, alpha, t, p);
  else
    no_ray_refraction(slot);
  return 0.0;
}

// `there`: a lane without a hit only helps to read.
void shade_hit(uint slot, uint parents, uint triangle, float t, Parent p, bool is_active) {
  Corners corners = load_triangle(triangle);
  TriangleHit at = project_to_triangle(make_shear(p.ray.origin, p.ray.direction), corners.a, corners.b, corners.c, 0.0);
  if (RANKED) t = at.t;  // the other says where the hit counts
  Material m;
  Surface s = surface_at(triangle, at.barycentric, p.ray.direction, p.cone_width + p.cone_spread * t, m);
  set_ranks(corners.instance, at.clockwise, s);
  float covers = 0.0;  // what is absorbed hides what is behind
  if (VOLUMES) {
    vec3 left = absorbed(p, s, m, t);
    p.weight *= left;
    if (GLASS_ALPHA) {
      covers = p.coverage * (1.0 - mean_of(left));
      p.coverage *= mean_of(left);
    }
  }
  float alpha = (m.flags & MATERIAL_BLEND) != 0u ? clamp(s.base.a, 0.0, 1.0) : 1.0;
  if (alpha < 1.0) s.transmission = 0.0;  // one straight ray goes on; see SHADING.md, 1
  vec3 weight = p.weight * alpha;
  bool unlit = (m.flags & MATERIAL_UNLIT) != 0u;
  vec3 v = -p.ray.direction;
  float nv = clamp(dot(s.normal, v), 1e-4, 1.0);
  Lobes lobes = lobes_of(s, m.ior, nv);
  Interface face;
  if (TRANSLUCENT && s.transmission > 0.0) see_through(s, m, p, nv, lobes, face);
  vec3 own = unlit ? s.base.rgb : s.emission + frame.environment * ambient_of(s, lobes) * s.occlusion;
  covers += p.coverage * alpha;
  if (is_active && GLASS_ALPHA) covers -= make_secondary_rays(slot, s, m, t, weight, alpha, p, lobes, face);
  if (is_active) add_own(p.pixel, weight * own, covers);
  if (SHADOWS)
    for (uint i = 0u; i < frame.lights; ++i) {
      Light light = load_light_subgroup(i);
      if (!is_active) continue;
      uint shadow_slot = slot + i * parents;
      if (unlit)
        no_ray_shadow(shadow_slot);
      else
        make_shadow_ray(shadow_slot, light, i, s, weight, lobes, v, p.pixel);
    }
  if (is_active && !GLASS_ALPHA) make_secondary_rays(slot, s, m, t, weight, alpha, p, lobes, face);
}

void main() {
  uint i = global_index(), rays = counters[COUNT_RAYS + push.kind];
  bool is_active = i < rays;
  i = min(i, rays - 1u);  // lanes past the last help to read
  uint parents = counters[COUNT_PARENTS];
  uint slot = i + (push.kind == KIND_REFRACTION ? counters[COUNT_RAYS + KIND_REFLECTION] : 0u);
  uvec2 hit;
  Parent p = RASTER && push.direct != 0u ? camera_parent(i, hit) : load_parent(ray_list, push.kind, i, hit);
  bool hits = is_active && hit.x != NO_INDEX;
  count_tests(push.kind, STAT_HITS, hits ? 1u : 0u);
  if (continues(hits)) shade_hit(slot, parents, value_or_first(hit.x, hits), uintBitsToFloat(hit.y), p, hits);
  if (hits || !is_active) return;
  add_own(p.pixel, p.coverage > 0.0 ? vec3(0) : p.weight * frame.environment, 0.0);
  if (SHADOWS)
    for (uint k = 0u; k < frame.lights; ++k) no_ray_shadow(slot + k * parents);
  no_ray_reflection(slot);
  no_ray_refraction(slot);
}
