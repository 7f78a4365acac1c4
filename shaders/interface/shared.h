// SPDX-License-Identifier: MIT
// The one header that GLSL and C++ share: bindings, sizes, structs. Scalar layout on both sides (vec3 = 12 bytes).
#ifndef SHEAF_SHARED_H
#define SHEAF_SHARED_H

#include "interface/bindings.h"

#ifdef __cplusplus
#include <cstdint>
#include <glm/glm.hpp>
namespace sheaf::gpu {
using uint = std::uint32_t;
using vec2 = glm::vec2;
using vec3 = glm::vec3;
using vec4 = glm::vec4;
using uvec2 = glm::uvec2;
using mat3 = glm::mat3;
#define SHEAF_CONST inline constexpr uint
#define SHEAF_CONST_FLOAT inline constexpr float
#else
#define SHEAF_CONST const uint
#define SHEAF_CONST_FLOAT const float
#endif

SHEAF_CONST NO_INDEX = 0xFFFFFFFFu;

// Kinds of ray, in the order of the stats.
SHEAF_CONST KIND_PRIMARY = 0u;
SHEAF_CONST KIND_SHADOW = 1u;
SHEAF_CONST KIND_REFLECTION = 2u;
SHEAF_CONST KIND_REFRACTION = 3u;

// A ray's words, in pairs (rays.glsl). A list has the first RAY_PART of all its rays, then the others: tracers read no
// more than the first.
SHEAF_CONST RAY_ORIGIN = 0u;     // 3 words
SHEAF_CONST RAY_DIRECTION = 3u;  // 3 words, unit length
SHEAF_CONST RAY_TMIN = 6u;
SHEAF_CONST RAY_TMAX = 7u;
SHEAF_CONST RAY_WEIGHT = 8u;     // 3 words; a shadow ray: the light it carries if nothing is in the way
SHEAF_CONST RAY_COVERAGE = 11u;
SHEAF_CONST RAY_MEDIUM = 12u;    // stack of four volume numbers, top in the low byte; a shadow ray: its light
SHEAF_CONST RAY_PAST = 13u;      // bounces, and from bit 16 on the blended surfaces it went straight through
// Width and spread of the ray's cone, where textures are filtered (SHADING.md, Texture filter).
SHEAF_CONST RAY_CONE = 14u;
SHEAF_CONST RAY_WORDS = 16u;
SHEAF_CONST RAY_PART = 8u;
// And behind the list's rays a word each: the ray's pixel in the tile; NO_INDEX: the slot holds no ray.
SHEAF_CONST RAY_SLOT_BYTES = 4u * (RAY_WORDS + 1u);

// Counters written by the device; one block, cleared at the start of a band.
SHEAF_CONST COUNT_PARENTS = 0u;       // rays whose hits the next generate reads
SHEAF_CONST COUNT_SLOTS = 1u;         // slots to compact: 1 + kind
SHEAF_CONST COUNT_RAYS = 5u;          // rays of the list at work: 5 + kind
SHEAF_CONST COUNT_CHUNKS = 9u;
SHEAF_CONST COUNT_OVERFLOW = 10u;     // not 0: the band needs more slots than there are
SHEAF_CONST COUNT_PAIRS = 11u;        // pairs that survived a level
SHEAF_CONST COUNT_INCOHERENT = 13u;        // bundles whose rays go one a lane: too wide, or given up
SHEAF_CONST COUNT_SURVIVORS = 15u;    // of a batch of pairs
SHEAF_CONST COUNT_BOUNDS = 16u;       // 6 words: ordered-integer bounds of the batch's origins
SHEAF_CONST COUNT_CELLS = 22u;        // packets or cells of the list
SHEAF_CONST COUNT_WALK_FIRST = 23u;   // cells at work: the first …
SHEAF_CONST COUNT_WALK_CELLS = 24u;   // … and how many; none once their pairs had no room
SHEAF_CONST COUNT_WALK_OVERFLOW = 25u;
SHEAF_CONST COUNT_OPEN = 26u;         // 1: some pair of the level has a node
SHEAF_CONST COUNT_PAIR_HALF = 27u;    // half of the pairs' buffer that holds the last level made
SHEAF_CONST COUNT_PAIR_HALVES = 28u;  // 2 words: pairs in each half
SHEAF_CONST COUNT_WALK_RAY = 30u;     // rays at work: the first …
SHEAF_CONST COUNT_WALK_RAYS = 31u;    // … and how many
SHEAF_CONST COUNT_WORDS = 32u;

// Blended surfaces that a ray may go through on its way from the camera; what is further is not seen.
SHEAF_CONST MOST_BLENDED = 64u;

// What a dispatch's rays are to the sums of their pixels: several may be for one pixel, no two are, or every pixel has
// one and the sums do not matter yet.
SHEAF_CONST SUMS_SHARED = 0u, SUMS_OWN = 1u, SUMS_UNSET = 2u;

// Statistics, 64-bit sums, a block of STAT_FIELDS a kind.
SHEAF_CONST STAT_RAYS = 0u;
SHEAF_CONST STAT_HITS = 1u;
SHEAF_CONST STAT_NODE_OBJECT = 2u;
SHEAF_CONST STAT_RAY_BOX = 3u;
SHEAF_CONST STAT_RAY_TRIANGLE = 4u;
SHEAF_CONST STAT_LEVELS = 5u;         // node-object tests of the levels 0 (rays) … 15
SHEAF_CONST STAT_STOPPED = 21u;       // rays that MOST_BLENDED stopped (of refraction rays; counted in any case)
SHEAF_CONST STAT_FIELDS = 22u;
SHEAF_CONST STAT_SUMS = 4u * STAT_FIELDS;

// Indirect dispatch arguments: three words each.
SHEAF_CONST ARGS_RAYS = 0u;       // one invocation a ray of the list
SHEAF_CONST ARGS_BLOCKS = 1u;     // one workgroup a scan block of the list
SHEAF_CONST ARGS_BUNDLES = 2u;    // one workgroup a bundle of the list
SHEAF_CONST ARGS_CHUNKS = 3u;     // one workgroup a sort block of the chunks
SHEAF_CONST ARGS_PARENTS = 4u;    // one invocation a parent
SHEAF_CONST ARGS_SLOTS = 5u;      // one workgroup a scan block of the slots
SHEAF_CONST ARGS_PAIR_SCATTER = 6u;  // like ARGS_PAIR_BLOCKS, or nothing where the next level has no room
SHEAF_CONST ARGS_INCOHERENT = 7u;      // one invocation per ray of an incoherent bundle
SHEAF_CONST ARGS_ONE = 8u;        // a single workgroup, or nothing when the list is empty
SHEAF_CONST ARGS_PARENTS_REFRACTION = 9u;
SHEAF_CONST ARGS_SLOTS_SHADOW = 10u;
SHEAF_CONST ARGS_PAIR_RANGES = 11u;    // one invocation a pair of the last level made
SHEAF_CONST ARGS_WALK_RUNS = 12u;      // one invocation a cell of the walk
SHEAF_CONST ARGS_WALK_CELLS = 13u;     // one workgroup a cell of the walk
SHEAF_CONST ARGS_PAIRS = 14u;          // one invocation a pair of the level at work
SHEAF_CONST ARGS_PAIR_BLOCKS = 15u;    // one workgroup a scan block of them
SHEAF_CONST ARGS_WALK_BLOCKS = 16u;    // one workgroup a scan block of the walk's rays
SHEAF_CONST ARGS_WALK_SCATTER = 17u;   // the same, or nothing where the cells have no room
SHEAF_CONST ARGS_CELL_BLOCKS = 18u;    // one workgroup a scan block of the walk's cells
SHEAF_CONST ARGS_COUNT = 19u;

SHEAF_CONST GROUP = 64u;          // invocations of a plain workgroup
SHEAF_CONST SCAN_GROUP = 32u;     // invocations of a scan workgroup …
SHEAF_CONST SCAN_RUN = 32u;       // … each with a run of elements: a serial loop is the cheapest scan on a CPU device
SHEAF_CONST SCAN_BLOCK = SCAN_GROUP * SCAN_RUN;
SHEAF_CONST RADIX_BITS = 4u;
SHEAF_CONST RADIX = 1u << RADIX_BITS;
SHEAF_CONST BUNDLE = 64u;         // rays of a packet, or of a bundle at least: level 3 of the arity-4 hierarchy
SHEAF_CONST ARITY = 4u;
SHEAF_CONST PART_TRIANGLES = 4u;  // of an instance, that one sphere stands for
SHEAF_CONST MAX_LEVELS = 16u;
// Steps of the fixed-point optical depth in one stop (factor 2): 2^-13 stops of rounding a crossing.
SHEAF_CONST OPTICAL_STEP = 4096u;

// Surface layers of a pixel.
SHEAF_CONST LAYER_DEPTH = 0u;
SHEAF_CONST LAYER_NORMAL = 1u;
SHEAF_CONST LAYER_POSITION = 4u;
SHEAF_CONST LAYER_ALBEDO = 7u;
SHEAF_CONST LAYER_UV = 10u;
SHEAF_CONST LAYER_OBJECT = 12u;
SHEAF_CONST LAYER_MATERIAL = 13u;
SHEAF_CONST LAYER_WORDS = 14u;

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

// Of Material::absorption: nothing passes, however short the way. Finite, so that times 0 it is 0.
SHEAF_CONST_FLOAT ABSORBS_ALL = 3e38f;

SHEAF_CONST MATERIAL_MASK = 1u;
SHEAF_CONST MATERIAL_BLEND = 2u;
SHEAF_CONST MATERIAL_UNLIT = 4u;
SHEAF_CONST MATERIAL_VOLUME = 8u;
SHEAF_CONST MATERIAL_TRANSMISSIVE = 16u;
SHEAF_CONST MATERIAL_ONE_SIDED = 32u;  // its back is passed through by all but shadow rays
// A triangle's last word: the instance (there are fewer than MAX_NODES, since each has a node), and what a hit must
// know at once: whether it needs a second look (alpha mask, lets light pass), whether the back counts, whether the node
// or skin mirrors, and its rank among what lies in the same place (ranks.glsl): three bits, and whether it turns with
// the side.
SHEAF_CONST TRIANGLE_MASKED = 0x80000000u;
SHEAF_CONST TRIANGLE_TRANSLUCENT = 0x40000000u;
SHEAF_CONST TRIANGLE_ONE_SIDED = 0x20000000u;
SHEAF_CONST TRIANGLE_MIRRORED = 0x10000000u;
SHEAF_CONST TRIANGLE_TURNS = 0x08000000u;
SHEAF_CONST TRIANGLE_RANK = 24u;  // its lowest bit
SHEAF_CONST TRIANGLE_INSTANCE_MASK = 0x00FFFFFFu;
// Of Instance::marks: the instance's place among the Deforms where a joint of its skin mirrors, else all ones.
SHEAF_CONST INSTANCE_DEFORM = 0x00FFFFFFu;
// A triangle of a material with any of these may let light through: shadow rays look closer.
SHEAF_CONST MATERIAL_NOT_OPAQUE = MATERIAL_MASK | MATERIAL_BLEND | MATERIAL_TRANSMISSIVE;

SHEAF_CONST LIGHT_DIRECTIONAL = 0u;
SHEAF_CONST LIGHT_POINT = 1u;
SHEAF_CONST LIGHT_SPOT = 2u;

// Bits of TextureUse::flags; bits 0–1 wrap s, 2–3 wrap t.
SHEAF_CONST TEXTURE_NEAREST = 16u;
SHEAF_CONST TEXTURE_UV1 = 32u;
SHEAF_CONST TEXTURE_HERE = 64u;

// Places in Material::uses; what shadow rays ask comes first.
SHEAF_CONST TEXTURE_BASE_COLOR = 0u;
SHEAF_CONST TEXTURE_METALLIC_ROUGHNESS = 1u;
SHEAF_CONST TEXTURE_TRANSMISSION = 2u;
SHEAF_CONST TEXTURE_NORMAL = 3u;
SHEAF_CONST TEXTURE_OCCLUSION = 4u;
SHEAF_CONST TEXTURE_EMISSIVE = 5u;
SHEAF_CONST TEXTURES = 6u;

// Words of the structures below.
SHEAF_CONST INSTANCE_WORDS = 34u;
SHEAF_CONST USE_WORDS = 12u;
SHEAF_CONST MATERIAL_USES = 18u;  // where they begin
SHEAF_CONST MATERIAL_WORDS = MATERIAL_USES + TEXTURES * USE_WORDS;
SHEAF_CONST LIGHT_PAIRS = 7u;

struct TextureUse {
  vec2 offset;
  vec2 scale;
  vec2 turn;         // cosine and sine of the rotation
  float strength;
  uint flags;
  uint first_texel;
  uint width;
  uint height;
  uint levels;       // of the mip chain behind first_texel; 1: only the image itself
};

struct Material {
  vec4 base_color;
  vec3 emissive;
  float metallic;
  float roughness;
  float alpha_cutoff;
  float transmission;
  float ior;
  vec3 absorption;  // −log2(attenuation color) / distance: stops a metre, at most ABSORBS_ALL
  uint flags;
  uint volume;      // 1 … 255 for volumes, else 0; volume n is material n − 1 of the buffer
  uint id;          // material of the file + 1
  TextureUse uses[TEXTURES];
};

struct Instance {
  vec3 row0;        // rows of the linear part, and the translation relative to the frame origin
  vec3 row1;
  vec3 row2;
  vec3 translation;
  vec3 normal0;     // rows of the inverse transpose (times the determinant's magnitude: directions only)
  vec3 normal1;
  vec3 normal2;
  float determinant_sign;
  uint first_triangle;
  uint triangle_count;
  uint first_index;
  uint first_vertex;
  uint uv0;         // offsets into their buffers, NO_INDEX where the mesh has none
  uint uv1;
  uint color;
  uint tangent;
  uint dynamic;     // first vertex in the dynamic buffer, NO_INDEX where the instance is rigid
  uint material;
  uint object;      // node + 1
  // INSTANCE_DEFORM, and TRIANGLE_RANK and TRIANGLE_TURNS as in its triangles' words; read by animate_triangles only.
  uint marks;
};                  // (structures read by address are whole pairs of words, see memory.glsl)

struct Light {
  vec3 position;
  uint kind;
  vec3 direction;   // the way the light travels
  float range;
  vec3 radiance;    // color · intensity
  float spot_scale;
  float spot_offset;
  uint unused;      // whole pairs of words, as the structures above
};

struct Frame {      // per frame and batch of samples
  vec3 eye;         // relative to the frame origin
  float near;
  // Camera axes, scaled by half the image plane's extent at distance 1 (perspective) or by its half extents.
  vec3 right;
  float far;
  vec3 up;
  uint orthographic;
  vec3 forward;
  float cutoff;
  vec3 environment;
  uint width;
  uint height;
  vec2 place;         // of the sample in its pixel; unused where a batch holds several samples
  uint batch_rays;    // camera rays of this batch: pixels times samples
  uint batch_samples;
  float cone_width;   // of a camera ray at its origin …
  float cone_spread;  // … and what a unit of t adds to it
  uint lights;
  uint triangles;
  uint capacity;    // slots of a ray list
  uint instances;
  uint sample_index;  // the batch's first
  float box_pad;    // what every box is widened by: 2^-21 of the largest coordinate, see triangle.glsl
  uint tile_x;
  uint tile_y;
  uint tile_width;
  uint tile_height;
  float rank_extent;  // of the surfaces that have ranks, see ranks.glsl
  uint depth;         // most bounces of a ray
  uvec2 triangles_at;  // device addresses, low word first: see memory.glsl
  uvec2 nodes_at;
  uvec2 indices_at;
  uvec2 positions_at;
  uvec2 normals_at;
  uvec2 tangents_at;
  uvec2 uvs_at;
  uvec2 colors_at;
  uvec2 dynamic_at;
  uvec2 texels_at;
  uvec2 instances_at;
  uvec2 materials_at;
  uvec2 lights_at;
  uvec2 sums_at;
};

struct Deform {     // one deforming instance's vertices
  uint first_vertex;     // static, object space
  uint vertex_count;
  uint dynamic;
  uint joint_words;      // offset into the joint index/weight buffer, NO_INDEX: not skinned
  uint first_matrix;     // 3x4 matrices, of this instance's skin
  uint morph_first;      // vec3 offset of the first target's positions
  uint morph_targets;
  uint weight_first;
  uint tangent;
  uint instance;
  uint morph_normals;    // vec3 offset of the first target's normals, NO_INDEX: none
  uint morph_tangents;
  uint flat_faces;       // not 0: its normals are those of its deformed triangles, written as 0
  uint uv_from[2];       // where texture coordinates or colors are morphed: from the mesh's own place in their buffer
  uint uv_to[2];         // to the instance's, …
  uint uv_morphs[2];     // … by deltas: vec3 offset of the first target's (u, v, 0), NO_INDEX: none
  uint color_from;
  uint color_to;
  uint color_morphs;     // r, g, b
  uint alpha_morphs;     // (a, 0, 0)
  // Of flat faces with tangents: vec3 offset of (a, b, 0) a triangle, see Mesh::face_tangents; else NO_INDEX.
  uint face_tangents;
};

#ifdef __cplusplus
static_assert(sizeof(TextureUse) == 4 * USE_WORDS);
static_assert(sizeof(Material) == 4 * MATERIAL_WORDS);
static_assert(sizeof(Instance) == 4 * INSTANCE_WORDS);
static_assert(sizeof(Light) == 8 * LIGHT_PAIRS);
}  // namespace sheaf::gpu
#endif
#endif
