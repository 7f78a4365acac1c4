// SPDX-License-Identifier: MIT
// Accessors turned into plain arrays. Every range, stride, alignment, sparse index and float is checked here; nothing
// else in the loader touches the bytes of a buffer.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <map>
#include <string>
#include <vector>

#include "scene/gltf_file.hpp"

namespace sheaf {

/// Which component types an accessor's use allows.
enum class Components {
  floats,             // FLOAT alone
  floats_normalized,  // FLOAT, or 8/16-bit integers that are normalised
  floats_quantized,   // FLOAT, or any 8/16-bit integers (KHR_mesh_quantization)
};

/// Elements that were compressed, without gaps, in their accessor's type.
struct DecodedElements {
  std::size_t count = 0;
  std::vector<std::uint8_t> bytes;
};
using DecodedAccessors = std::map<int, DecodedElements>;  // by the accessor's index

class Accessors {
 public:
  explicit Accessors(const GltfFile& file) : file_(file) {}
  /// `decoded` is read instead of the bufferViews of the accessors that it has.
  Accessors(const GltfFile& file, const DecodedAccessors& decoded) : file_(file), decoded_(&decoded) {}

  /// `width` numbers an element: 1 SCALAR … 4 VEC4, 16 MAT4 (column-major). Integers that are marked normalised are
  /// scaled to [0, 1] or [-1, 1] (glTF 2.0, 3.6.2.2). `use` says in errors what the accessor is for.
  [[nodiscard]] std::vector<float> floats(int accessor, int width, Components allowed, const std::string& use) const;

  /// Unsigned integers: 8 or 16 bits, and 32 where `allow_32`.
  [[nodiscard]] std::vector<std::uint32_t> integers(int accessor, int width, bool allow_32,
                                                    const std::string& use) const;

  /// How many elements it has, once they are known to be there: whoever makes room for as many need not look again.
  [[nodiscard]] std::size_t count(int accessor) const;
  /// 3 or 4 for VEC3 and VEC4 and so on; 16 for MAT4.
  [[nodiscard]] int width(int accessor) const;

 private:
  struct Source {                        // a checked window onto bytes
    const std::uint8_t* data = nullptr;  // null: all zero
    std::size_t stride = 0, count = 0;
  };
  [[nodiscard]] const tinygltf::Accessor& get(int accessor) const;
  [[nodiscard]] const DecodedElements* decoded_elements(int accessor) const;
  [[nodiscard]] Source window(const std::string& place, int view, std::uint64_t offset, std::size_t count,
                              std::size_t element, std::size_t component) const;
  [[nodiscard]] Source dense(int accessor) const;
  [[nodiscard]] Source dense(int accessor, int width, const std::string& use) const;
  template <class T>
  void overlay_sparse(int accessor, int width, std::vector<T>& values) const;
  [[nodiscard]] std::vector<std::uint32_t> sparse_indices(int accessor) const;
  void check_finite(int accessor, int width, const std::vector<float>& values, const std::string& use) const;

  const GltfFile& file_;
  const DecodedAccessors* decoded_ = nullptr;
};

}  // namespace sheaf
