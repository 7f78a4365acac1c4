// SPDX-License-Identifier: MIT
// Materials, textures, instances and lights as the device has them.
#ifndef SHEAF_INTERFACE_SCENE_H
#define SHEAF_INTERFACE_SCENE_H
#include "interface/material_table.h"
#include "interface/types.h"
SHEAF_INTERFACE_BEGIN

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

// Places in Material::uses, how many there are, and a bit for each that holds colours.
#define PLACE(number, place, field, owner, key, content) SHEAF_CONST place = number;
#define COUNT_ONE(number, place, field, owner, key, content) +1u
#define COLOR_BIT(number, place, field, owner, key, content) | (content << number)
MATERIAL_TEXTURES(PLACE)
SHEAF_CONST TEXTURES = 0u MATERIAL_TEXTURES(COUNT_ONE);
SHEAF_CONST COLOR_TEXTURES = 0u MATERIAL_TEXTURES(COLOR_BIT);
#undef PLACE
#undef COUNT_ONE
#undef COLOR_BIT

// Words of the structures below.
SHEAF_CONST INSTANCE_WORDS = 34u;
SHEAF_CONST USE_WORDS = 12u;
#define WORDS(type, words, field, value, owner, key, low, high) +words
SHEAF_CONST FACTOR_WORDS = 0u MATERIAL_FACTORS(WORDS);
#undef WORDS
SHEAF_CONST MATERIAL_USES = FACTOR_WORDS + 6u;  // where they begin
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
#define FIELD(type, words, field, value, owner, key, low, high) type field;
  MATERIAL_FACTORS(FIELD)
#undef FIELD
  vec3 absorption;  // −log2(attenuation color) / distance: stops per metre, at most ABSORBS_ALL
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

SHEAF_INTERFACE_END

#ifdef __cplusplus
static_assert(sizeof(sheaf::gpu::TextureUse) == 4 * sheaf::gpu::USE_WORDS);
static_assert(sizeof(sheaf::gpu::Material) == 4 * sheaf::gpu::MATERIAL_WORDS && sheaf::gpu::MATERIAL_USES % 2 == 0);
static_assert(sizeof(sheaf::gpu::Instance) == 4 * sheaf::gpu::INSTANCE_WORDS);
static_assert(sizeof(sheaf::gpu::Light) == 8 * sheaf::gpu::LIGHT_PAIRS);
#endif
#endif
