// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// Traverse and intersect for `hybrid`: one subgroup bounds a bundle of rays (bundle_rays.glsl) and walks the object
// hierarchy with it. Lanes are a node's children when boxes are tested. Bundles that are too wide to be walked as one,
// and those that turn out to be, go to a list.
//
// Exact: see beam.glsl; the cone test is padded. Control flow as in single_ray.glsl.
#define COMPUTE
#include "lib/common.glsl"
#include "interface/push/trace.h"
#include "lib/push.glsl"
#include "lists/rays.glsl"
#include "scene/scene.glsl"
#include "trace/common/candidate.glsl"
#include "trace/common/results.glsl"
#include "lib/counters.glsl"
#include "lib/args.glsl"
#include "lib/counting.glsl"
#include "trace/common/visit.glsl"
#include "trace/bundles/beam.glsl"
PUSH(TraverseBundlesPush);

#include "trace/bundles/bundle_leaves.glsl"
#include "trace/common/visit_subgroup.glsl"
#include "trace/bundles/incoherent.glsl"

Visit visit;  // the same in all lanes

// Children that some ray of the bundle may enter, a bit each; their boxes stay with the lanes.
uint entered_children(Beam beam, Cone cone, uint node) {
  Boxes boxes = load_boxes_subgroup(node);
  uint entered = 0u;
  for (uint base = 0u; base < WIDE; base += LANES) {
    uint c = base + bundle.lane;
    vec3 lo, hi;
    child_box(boxes, c & 7u, lo, hi);
    if (base == 0u)
      bundle.lower_leaf = Leaf(lo, hi, 0u);
    else
      bundle.upper_leaf = Leaf(lo, hi, 0u);
    bool is_active = c < WIDE && (boxes.grid.present & (1u << c)) != 0u;
    if (is_active) ++bundle.node_tests;
    bool enters =
        is_active && beam_enters(beam, lo, hi) && cone_meets_sphere(cone, 0.5 * lo + 0.5 * hi, 0.5 * length(hi - lo));
    entered |= lanes_where(enters, WIDE) << base;
  }
  return entered & 255u;
}

void visit_node(Beam beam, Cone cone, uint node) {
  uint entered = entered_children(beam, cone, node);
  if (entered == 0u) return;
  hold_children(node);
  uint entered_leaves = entered & leaf_children();
  visit_children_subgroup(visit, node, entered & ~entered_leaves);
  if (entered_leaves == 0u) return;
  bundle.lower_leaf.word = children.x;
  bundle.upper_leaf.word = children.y;
  hand_out_leaves(in_visiting_order(entered_leaves, visit.octant), visit.octant);
}

// Whether it came to the end: a bundle that finds too much to look at gives up.
bool walk(Beam beam, Cone cone) {
  uint current = 0u;
  while (current != CHILD_EMPTY || bundle.todo != 0u) {
    while (bundle.todo == 0u && current != CHILD_EMPTY) {
      if (++bundle.effort > push.most_effort) return false;
      visit_node(beam, cone, current);
      current = next_child_subgroup(visit);
    }
    while (bundle.todo != 0u && waiting_has_room()) test_vector();
    if (bundle.todo != 0u || current == CHILD_EMPTY) settle_waiting();
    beam.farthest = farthest_hit();
    if (!(beam.farthest > -INFINITY)) {  // every shadow ray is blocked
      current = CHILD_EMPTY;
      bundle.todo = 0u;
    }
  }
  return true;
}

void main() {
  uint rays_here = counters[COUNT_RAYS + push.kind], number = global_group(), first = number * BUNDLE_RAYS;
  if (first >= rays_here) return;
  begin_bundle(ray_list, first, min(BUNDLE_RAYS, rays_here - first));
  Beam beam = load_bundle();
  RayNode node = bundle_bound(bundle.spread);
  bool incoherent = bundle.ray_count < 8u || is_incoherent(node, bundle.spread, push.widest);
  visit = Visit(0u, 0u, octant_of(node.axis));
  if (!incoherent && walk(beam, cone_of(node))) {
    [[dont_unroll]] for (uint v = 0u; v < bundle.vectors; ++v) store(v);
  } else if (bundle.lane == 0u) {
    fall_back_to_single_rays(number);  // what it found is found again
  }
  count_tests(push.kind, STAT_NODE_OBJECT, bundle.node_tests);
  count_tests(push.kind, STAT_LEVELS + 3u, bundle.node_tests);
  count_tests(push.kind, STAT_RAY_BOX, bundle.box_tests);
  count_tests(push.kind, STAT_RAY_TRIANGLE, bundle.triangle_tests);
}
