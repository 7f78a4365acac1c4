// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_ray_query : require
// Strategy `rayquery`: the driver's acceleration structure finds candidate boxes of triangles, our own test decides.
// The driver's triangle test would not give the same bytes: its edge rule and its t are its own.
#define COMPUTE
#include "lib/common.glsl"
#include "interface/push/push.h"
#include "lib/push.glsl"
#include "lists/rays.glsl"
#include "scene/scene.glsl"
#include "trace/common/candidate.glsl"
#include "trace/common/results.glsl"
#include "lib/counters.glsl"
#include "lib/counting.glsl"
layout(set = 0, binding = ROLE_STRUCTURE) uniform accelerationStructureEXT structure;
PUSH(KindPush);

void main() {
  uint i = global_index();
  if (i >= counters[COUNT_RAYS + push.kind]) return;
  uint slot = load_slot(ray_list.order, i);
  Ray ray = load_ray(ray_list.rays, slot);
  Shear s = make_shear(ray.origin, ray.direction);
  Nearest best = Nearest(ray.tmax, NO_INDEX);
  Shade shade = Shade(false, NO_INDEX, 0.0, ivec3(0));
  Pending pending = NOTHING_PENDING;
  uint tests = 0u;
  rayQueryEXT query;
  // The interval is a little wider than the ray's, for the same reason as the boxes.
  float far_limit = min(ray.tmax * 1.0001, 3.0e38);
  rayQueryInitializeEXT(query, structure, gl_RayFlagsNoneEXT, 0xFFu, ray.origin, 0.0, ray.direction, far_limit);
  while (rayQueryProceedEXT(query)) {
    uint triangle = uint(rayQueryGetIntersectionPrimitiveIndexEXT(query, false));
    ++tests;
    if (ANY_HIT) {
      consider_shadow(triangle, s, ray.tmin, ray.tmax, shade, pending);
      if (TRANSLUCENT) settle_shadow(ray.direction, ray.tmax, shade, pending);
      if (shade.blocked) {
        rayQueryTerminateEXT(query);
        break;
      }
    } else {
      float before = best.t;
      consider_nearest(triangle, s, ray.tmin, best, pending);
      if (MASKED) settle_nearest(best, pending);
      // Tell the driver how far to look: past our t by its rounding, so that equal hits are still shown.
      if (best.t < before)
        rayQueryGenerateIntersectionEXT(query, min(best.t * 1.0001 + 4.0 * frame.box_pad, far_limit));
    }
  }
  if (ANY_HIT)
    store_shade(ray_list.hits, slot, shade);
  else
    store_nearest(ray_list.hits, slot, best);
  count_tests(push.kind, STAT_RAY_TRIANGLE, tests);
  count_pixel(load_ray_pixel(ray_list.rays, slot), tests);
}
