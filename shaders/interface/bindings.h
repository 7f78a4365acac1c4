// SPDX-License-Identifier: MIT
// What GLSL and C++ call the constants, buffers and lists that a kernel is given.
#ifndef SHEAF_BINDINGS_H
#define SHEAF_BINDINGS_H

// Specialization constants: the size of a workgroup, what a scene has, what is asked of a kernel, and the device's
// subgroups.
#define SPEC_GROUP 0
#define SPEC_ANY_HIT 1
#define SPEC_MASKED 2
#define SPEC_TRANSLUCENT 3
#define SPEC_TEXTURED_NORMALS 4
#define SPEC_VOLUMES 5
#define SPEC_COUNTED 6
#define SPEC_PIXEL_COUNTED 7
#define SPEC_INCOHERENT 8
#define SPEC_TEXTURED 9
#define SPEC_LANES 10
#define SPEC_VECTORS 11
#define SPEC_TRANSFORM_ON_FETCH 12
#define SPEC_RASTER 13
#define SPEC_ADAPTIVE 14
#define SPEC_SHADOWS 15
#define SPEC_REFLECTIONS 16
#define SPEC_REFRACTIONS 17
#define SPEC_WORKERS 18
#define SPEC_BY_PARENT 19
#define SPEC_BUNDLE 20
#define SPEC_GLASS_ALPHA 21
#define SPEC_FACE_TANGENTS 22
#define SPEC_MIRRORED_SKINS 23
#define SPEC_MORPHED_ATTRIBUTES 24
#define SPEC_ONE_SIDED 25
#define SPEC_RANKED 26

// Roles of storage buffers. A role has the same binding number in every shader; a kernel declares the roles it reads.
#define ROLE_FRAME 0
#define ROLE_COUNTERS 1
#define ROLE_ARGS 2
#define ROLE_JOINT_MATRICES 3
#define ROLE_MORPH_WEIGHTS 4
#define ROLE_ORDER_KEPT 5
#define ROLE_SEEDS 6
#define ROLE_INSTANCES 7
#define ROLE_MATERIALS 14
#define ROLE_LIGHTS 17
#define ROLE_BLOCK_SUMS 26
#define ROLE_KEYS 27
#define ROLE_CHUNKS 28
#define ROLE_CHUNKS_ALT 29
#define ROLE_SKELETON 30
#define ROLE_RAY_NODES 31
#define ROLE_PAIRS 32
#define ROLE_PAIRS_NEXT 33
#define ROLE_SURVIVORS 34
#define ROLE_SPHERES 35
#define ROLE_RUNS 36
#define ROLE_OPTICAL_DEPTH 37
#define ROLE_VISIBILITY 38
#define ROLE_LAYERS 39
#define ROLE_PIXEL_TESTS 40
#define ROLE_ANIMATE_BLOCKS 41
#define ROLE_REFIT_NODES 42
#define ROLE_DYNAMIC 43
#define ROLE_DEFORM 44
#define ROLE_JOINTS 45
#define ROLE_MORPHS 46
#define ROLE_SCAN_IN 47   // of the scan of plain numbers
#define ROLE_SCAN_OUT 48
#define ROLE_INCOHERENT_BUNDLES 49
#define ROLE_STATS 50
#define ROLE_BOXES 51
#define ROLE_STRUCTURE 52  // the one role that is an acceleration structure
#define ROLE_ACTIVE_PIXELS 53
#define ROLE_SAMPLE_PLACES 54
#define ROLE_PACKET_KEYS 55
#define ROLE_PACKETS 56
#define ROLE_LISTS 57
#define ROLE_PAIR_LEVELS 58
#define ROLE_CLASS_BOUNDS 59
#define ROLE_CELLS 60
#define ROLE_CELLS_NEXT 61
#define ROLE_CELL_STOPS 62
#define ROLE_CELL_OFFSETS 63
#define ROLE_RAY_CELLS 64
#define ROLE_CELL_CUTS 65
#define ROLE_COUNT 66

// Parts of lists are known by address. Bound like the rest, they lie in the push constants from this byte on, in this
// order: those of the list at work, and the rays that generate writes.
#define LIST_ORDER 0
#define LIST_HITS 1
#define LIST_RAYS 2
#define LIST_SHADOW_RAYS 3
#define LIST_REFLECTION_RAYS 4
#define LIST_REFRACTION_RAYS 5
#define LIST_COUNT 6
#define PUSH_LISTS 80

#endif
