// SPDX-License-Identifier: MIT
// The scene as the engine sees it: plain data, checked once by the loader, never changed afterwards.
// Everything that depends on time is computed from it by `pose.hpp`. Units: metres, seconds, radians.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <string>
#include <vector>

#include "interface/material_table.h"

namespace sheaf {

inline constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

enum class Wrap : std::uint32_t { repeat = 0, mirrored_repeat = 1, clamp_to_edge = 2 };

struct Image {  // 8-bit RGBA, rows top to bottom as glTF's UV origin wants; colour space is the user's matter
  std::string name;
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgba;
};

struct Texture {
  std::uint32_t image = none;
  Wrap wrap_s = Wrap::repeat, wrap_t = Wrap::repeat;
  bool nearest = false;   // magnification filter; everything else is linear
  bool mipmapped = true;  // false where the sampler's minification filter has no mipmap
};

struct TextureUse {  // how a material reads a texture: KHR_texture_transform folded in
  std::uint32_t texture = none;
  std::uint32_t uv_set = 0;
  glm::vec2 offset{0}, scale{1};
  float rotation = 0;  // radians, counter-clockwise as the extension defines it
  float strength = 1;  // normal scale or occlusion strength
  [[nodiscard]] bool present() const { return texture != none; }
};

enum class AlphaMode : std::uint32_t { opaque = 0, mask = 1, blend = 2 };

struct Material {
  std::string name;
  using vec3 = glm::vec3;
  using vec4 = glm::vec4;
  // As the table names them; the strength of what is emissive is multiplied in.
#define SHEAF_FACTOR(type, words, field, value, owner, key, low, high) type field{value};
#define SHEAF_TEXTURE(number, place, field, owner, key, content) TextureUse field;
  MATERIAL_FACTORS(SHEAF_FACTOR)
  MATERIAL_TEXTURES(SHEAF_TEXTURE)
#undef SHEAF_FACTOR
#undef SHEAF_TEXTURE
  AlphaMode alpha_mode = AlphaMode::opaque;
  bool double_sided = false, unlit = false;
  float thickness = 0;  // > 0: a closed volume that refracts and absorbs; 0: thin-walled
  glm::vec3 attenuation_color{1};
  float attenuation_distance = std::numeric_limits<float>::infinity();
};

/// f(use, place, content) of each texture that a material may have; `place` in gpu::Material::uses.
template <typename AnyMaterial, typename Function>
void for_each_texture(AnyMaterial&& material, Function&& f) {
#define SHEAF_TEXTURE(number, place, field, owner, key, content) f(material.field, number, content);
  MATERIAL_TEXTURES(SHEAF_TEXTURE)
#undef SHEAF_TEXTURE
}

struct MorphTarget {  // deltas, one an attribute a vertex; an empty vector is all zero
  std::vector<glm::vec3> positions, normals, tangents;
  std::vector<glm::vec2> uv0, uv1;
  std::vector<glm::vec4> colors;
};

struct Mesh {            // one glTF primitive of triangles: one material
  std::string name;      // "meshes[3].primitives[0] (Body)"
  glm::dvec3 centre{0};  // positions are stored relative to it, so that far-off vertices keep their precision
  std::vector<glm::vec3> positions;                  // object space minus centre
  std::vector<glm::vec3> normals;                    // unit, same count; the rest pose's flat ones where `flat`
  std::vector<glm::vec4> tangents;                   // empty unless the material has a normal map; w = handedness
  std::vector<glm::vec2> uv0, uv1;                   // empty where the file has none
  std::vector<glm::vec4> colors;                     // linear RGBA, empty where the file has none
  std::vector<std::array<std::uint16_t, 8>> joints;  // empty unless skinned; unused places have weight 0
  std::vector<std::array<float, 8>> weights;         // normalised to sum 1
  std::vector<MorphTarget> targets;
  std::vector<glm::uvec3> triangles;
  // The file has no normals: triangle t has vertices 3t, 3t + 1, 3t + 2 to itself, and where it is deformed its normal
  // is that of its deformed corners.
  bool flat = false;
  std::vector<glm::vec2> face_tangents;  // of flat ones with tangents, a triangle: (a, b), +u runs along a·e1 + b·e2
  std::uint32_t material = 0;            // index into Scene::materials, always valid
};

struct Skin {
  std::vector<std::uint32_t> joints;     // nodes
  std::vector<glm::dmat4> inverse_bind;  // one a joint
};

enum class LightKind : std::uint32_t { directional = 0, point = 1, spot = 2 };

struct Light {
  std::string name;
  LightKind kind = LightKind::point;
  glm::vec3 color{1};   // linear
  float intensity = 1;  // candela (point, spot) or lux (directional)
  float range = std::numeric_limits<float>::infinity();
  float inner_cone = 0, outer_cone = 0.785398163f;  // half-angles
};

struct Camera {
  std::string name;
  bool orthographic = false;
  double yfov = 0.7853981633974483;  // vertical; perspective
  double aspect = 0;                 // of the file; 0: unspecified, the image's own is used
  double ymag = 1, xmag = 1;         // half extents; orthographic
  double near = 0, far = std::numeric_limits<double>::infinity();
  std::string fault = {};  // why it cannot be used, as an error's text; empty: it can
};

struct Node {
  std::string name;
  std::uint32_t parent = none;
  std::vector<std::uint32_t> children;
  bool has_matrix = false;  // then `matrix` holds and the node is never animated
  glm::dmat4 matrix{1};
  glm::dvec3 translation{0};
  glm::dquat rotation{1, 0, 0, 0};
  glm::dvec3 scale{1};
  std::uint32_t first_mesh = 0, mesh_count = 0;  // range in Scene::meshes: the primitives of its glTF mesh
  std::uint32_t skin = none, camera = none, light = none;
  std::vector<double> morph_weights;  // rest weights: the node's, else the mesh's
  bool visible = true;                // KHR_node_visibility, of the node itself
  bool shown = true;                  // it and all it hangs from are visible; else it has no mesh and no light
  std::vector<glm::dmat4> instances;  // EXT_mesh_gpu_instancing: each relative to the node; empty: one, identity
};

enum class Interpolation { step, linear, cubic_spline };
enum class ChannelPath { translation, rotation, scale, weights };

struct Channel {
  std::uint32_t node = none;
  ChannelPath path = ChannelPath::translation;
  Interpolation interpolation = Interpolation::linear;
  std::uint32_t width = 3;     // components of a value: 3, 4, or the number of morph weights
  std::vector<double> times;   // strictly increasing, at least one
  std::vector<double> values;  // times × width; CUBICSPLINE: times × 3 × width (in-tangent, value, out-tangent)
};

struct Animation {
  std::string name;
  std::vector<Channel> channels;
  double duration = 0;     // last key of any channel
  std::string fault = {};  // why it cannot be used, as an error's text; empty: it can
};

struct Scene {
  std::string path;    // as given
  std::string sha256;  // of the scene file and of what it refers to beside it, hex; names the scene in EXR attributes
  std::vector<Image> images;
  std::vector<Texture> textures;
  std::vector<Material> materials;  // at least one: the default
  std::vector<Mesh> meshes;         // flattened: one a primitive
  std::vector<Node> nodes;
  std::vector<std::uint32_t> roots;  // of the chosen glTF scene
  std::vector<std::uint32_t> order;  // nodes reachable from roots, parents before children
  // Joints that are not in the scene and what they hang from, parents before children: they move, and show nothing.
  std::vector<std::uint32_t> outside;
  std::vector<Skin> skins;
  std::vector<Light> lights;
  std::vector<Camera> cameras;
  std::vector<Animation> animations;
  std::vector<std::string> variants;            // names of KHR_materials_variants
  std::vector<std::string> warnings;            // one line each
  std::vector<std::string> extensions_read;     // in extensionsUsed, and taken into account
  std::vector<std::string> extensions_ignored;  // in extensionsUsed, not supported
};

}  // namespace sheaf
