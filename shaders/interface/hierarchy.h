// SPDX-License-Identifier: MIT
// Triangles, nodes over triangles and nodes over rays: their words in memory.
#ifndef SHEAF_INTERFACE_HIERARCHY_H
#define SHEAF_INTERFACE_HIERARCHY_H
#include "interface/types.h"
SHEAF_INTERFACE_BEGIN

// Triangles in world space, relative to the frame origin: corners a, b, c, then the word of instance and flags (below).
// Only that word where triangles are transformed when they are read (Plan::transform_on_fetch).
SHEAF_CONST TRIANGLE_WORDS = 10u;
SHEAF_CONST TRIANGLE_INSTANCE = 9u;

// Object hierarchy: 8-wide nodes of 24 words. Children's boxes are bytes on a grid of the node's own (Ylitie, Karras,
// Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", HPG 2017), rounded outwards:
// origin.xyz, (exponents of the grid's steps x, y, z and the children there are, a byte each), lo.x[8] lo.y[8] lo.z[8]
// hi.x[8] hi.y[8] hi.z[8] as bytes, child[8].
SHEAF_CONST WIDE = 8u;
SHEAF_CONST LEAF_TRIANGLES = 4u;     // the most of a leaf
SHEAF_CONST NODE_WORDS = 24u;
SHEAF_CONST NODE_STEPS = 3u;
SHEAF_CONST NODE_BOXES = 4u;
SHEAF_CONST NODE_CHILD = 16u;
SHEAF_CONST CHILD_EMPTY = 0xFFFFFFFFu;
SHEAF_CONST CHILD_LEAF = 0x80000000u;  // bits 27..30 count − 1, bits 0..26 first triangle
// One entry per level: the node's children still to visit; two trees of MAX_LEVELS each.
SHEAF_CONST STACK_SIZE = 32u;
SHEAF_CONST MAX_NODES = 1u << 24;     // a stack entry holds a node and a mask of eight children

// Nodes of the ray hierarchy: sphere of the origins (centre, radius), cone of the directions (axis, half-angle): the 8
// floats of R 4.3; and the largest far limit, so that shadow rays end at their light.
SHEAF_CONST RAY_NODE_WORDS = 9u;

// Frustums of packets and cells (frustum_memory.glsl), and what their pairs with nodes entered: a bit a child in
// visiting order, and the octant of that order; or that the pair has a leaf, and is kept.
SHEAF_CONST FRUSTUM_WORDS = 12u;
// Classes of rays: face, then so many halvings, are the key. A cell with no more candidates than CLASS_FEW, all leaves,
// stays whole; one that is crowded is divided where cuts are marked CUT_SMALL as well.
SHEAF_CONST CLASS_HALVINGS = 25u;
SHEAF_CONST CLASS_FEW = 4u;
SHEAF_CONST CUT_SMALL = 256u;
SHEAF_CONST CELL_STOPS = 1u, CELL_CROWDED = 2u;
SHEAF_CONST PAIR_KEPT = 256u;
SHEAF_CONST PAIR_OCTANT = 9u;  // its lowest bit

SHEAF_INTERFACE_END
#endif
