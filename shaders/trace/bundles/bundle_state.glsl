// SPDX-License-Identifier: MIT
// All that a subgroup knows of the rays that it carries through a scene together (bundle_rays.glsl), in one place: the
// rays themselves, what waits to be tested, and counts. It is one variable, all that the files of bundles
// share: as a parameter it would be copied in and out of every call, arrays and all.
#ifndef SHEAF_BUNDLE_STATE_GLSL
#define SHEAF_BUNDLE_STATE_GLSL
#include "interface/hierarchy.h"
#include "interface/rays.h"
#include "lib/common.glsl"
#include "lib/lanes.glsl"
#include "trace/bundles/beam.glsl"
#include "trace/bundles/bundle_bound.glsl"
layout(constant_id = SPEC_VECTORS) const uint VECTORS = 8;  // of LANES rays each, at most

const uint HELD_LEAVES = 2u * VECTORS;
const uint QUEUE = LEAF_TRIANGLES * (2u * HELD_LEAVES);

struct Leaf {
  vec3 lo, hi;
  uint word;
};

struct BundleState {
  ListAddresses list;  // that the rays are of
  uint lane;
  uint first_ray, ray_count;
  uint vectors;  // that hold rays

  // A lane's ray of each vector.
  vec3 origin[VECTORS], inverse[VECTORS], shear[VECTORS];
  uint axis[VECTORS], slot[VECTORS], triangle[VECTORS];
  float tmin[VECTORS];
  float nearest[VECTORS];  // t so far; −∞ once there is nothing more to find
  float end[VECTORS];      // far limit of a shadow ray, or t where it is blocked
  ivec3 optical_depth[VECTORS];
  Beam vector_beam;  // lane v: of vector v
  Spread spread;     // of the bundle

  // Leaves of the node at work (bundle_leaves.glsl).
  Leaf lower_leaf, upper_leaf;  // of this lane; second: the upper four, where there are only four lanes
  uint leaf_turn;               // the k-th to be visited is in lane k ^ leaf_turn
  uint leaves;                  // entered by the bundle: bit k, the k-th to be visited
  uint own_leaves;              // lane v: those that vector v enters
  uint todo;                    // vectors that enter some
  uint leaves_left;             // of the first of them, where there was no room for more

  // Leaves that wait, of this lane, and hits that wait for their material (bundle_queue.glsl).
  uint held_vector[HELD_LEAVES], held_leaf[HELD_LEAVES];
  uint held;
  uint queued_vector[QUEUE], queued_triangle[QUEUE];
  float queued_t[QUEUE];
  uint queued;
  uint most_held, most_queued;  // no lane has more of either; the same in all lanes

  uint box_tests, triangle_tests, node_tests;
  uint effort;  // nodes and vectors looked at; the same in all lanes
};

BundleState bundle;

// Arrays of one value per vector of rays: an element is picked by comparing with every index, which costs a CPU device
// a third of what a gather does. V is the same in all lanes.
#define PICK(result, array, v) \
  { \
    result = array[0]; \
    [[unroll]] for (uint pick_ = 1u; pick_ < VECTORS; ++pick_) result = (v) == pick_ ? array[pick_] : result; \
  }
#define PUT(array, v, value) \
  [[unroll]] for (uint put_ = 0u; put_ < VECTORS; ++put_) array[put_] = (v) == put_ ? value : array[put_]

void begin_bundle(ListAddresses list, uint first_ray, uint ray_count) {
  bundle.list = list;
  bundle.lane = gl_SubgroupInvocationID;
  bundle.first_ray = first_ray;
  bundle.ray_count = ray_count;
  bundle.vectors = (ray_count + LANES - 1u) / LANES;
  bundle.leaves = bundle.todo = bundle.leaves_left = 0u;
  bundle.held = bundle.queued = bundle.most_held = bundle.most_queued = 0u;
  bundle.box_tests = bundle.triangle_tests = bundle.node_tests = bundle.effort = 0u;
}
#endif
