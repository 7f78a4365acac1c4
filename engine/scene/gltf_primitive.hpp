// SPDX-License-Identifier: MIT
// Reading the attributes of one primitive, which vertices and their deformation have in common.
#pragma once

#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include "scene/gltf_accessor.hpp"
#include "scene/gltf_file.hpp"
#include "scene/scene.hpp"

namespace sheaf {

struct PrimitiveReader {
  GltfFile& file;
  const Accessors& accessors;
  const tinygltf::Primitive& primitive;
  std::string place;
  std::size_t vertices = 0;
  bool skinned = false;                                         // a node gives the mesh a skin
  const std::vector<std::uint32_t>* decoded_indices = nullptr;  // of a compressed primitive: a list of triangles

  [[nodiscard]] int accessor(const char* attribute) const {
    const auto found = primitive.attributes.find(attribute);
    return found == primitive.attributes.end() ? -1 : found->second;
  }
};

template <class V>
std::vector<V> as_vectors(const std::vector<float>& values) {
  static_assert(std::is_trivially_copyable_v<V>);
  std::vector<V> out(values.size() * sizeof(float) / sizeof(V));
  if (!out.empty()) std::memcpy(out.data(), values.data(), out.size() * sizeof(V));
  return out;
}

/// An attribute's values, or nothing where the primitive has none. Every attribute has as many elements as POSITION.
template <class V>
std::vector<V> attribute(const PrimitiveReader& in, const char* name, Components allowed) {
  const int accessor = in.accessor(name);
  if (accessor < 0) return {};
  if (in.accessors.count(accessor) != in.vertices) {
    in.file.fail(in.place, std::string(name) + " has " + std::to_string(in.accessors.count(accessor)) +
                               " elements, POSITION " + std::to_string(in.vertices));
  }
  return as_vectors<V>(in.accessors.floats(accessor, sizeof(V) / sizeof(float), allowed, name));
}

}  // namespace sheaf
