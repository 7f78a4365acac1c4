// SPDX-License-Identifier: MIT
#include "scene/gltf_accessor.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>

namespace sheaf {
namespace {

std::size_t component_size(int type) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return 4;
    default:
      return 0;
  }
}

const char* type_name(int type) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return "BYTE";
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return "UNSIGNED_BYTE";
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return "SHORT";
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return "UNSIGNED_SHORT";
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return "UNSIGNED_INT";
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return "FLOAT";
    default:
      return "unknown";
  }
}

template <class From, class To>
To convert(From value, bool normalized) {
  if constexpr (std::is_same_v<From, float> || !std::is_floating_point_v<To>) {
    return static_cast<To>(value);
  } else {
    if (!normalized) return static_cast<To>(value);
    return std::max(static_cast<To>(value) / static_cast<To>(std::numeric_limits<From>::max()), To{-1});
  }
}

template <class From, class To>
void gather(const std::uint8_t* data, std::size_t stride, std::size_t count, int width, bool normalized, To* out) {
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint8_t* element = data + i * stride;
    for (int c = 0; c < width; ++c) {
      From value;
      std::memcpy(&value, element + static_cast<std::size_t>(c) * sizeof(From), sizeof(From));
      *out++ = convert<From, To>(value, normalized);
    }
  }
}

template <class To>
void gather(int type, const std::uint8_t* data, std::size_t stride, std::size_t count, int width, bool normalized,
            To* out) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return gather<std::int8_t>(data, stride, count, width, normalized, out);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return gather<std::uint8_t>(data, stride, count, width, normalized, out);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return gather<std::int16_t>(data, stride, count, width, normalized, out);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return gather<std::uint16_t>(data, stride, count, width, normalized, out);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return gather<std::uint32_t>(data, stride, count, width, normalized, out);
    default:
      return gather<float>(data, stride, count, width, normalized, out);
  }
}

std::string accessor_name(int accessor) { return at("accessors", static_cast<std::size_t>(accessor)); }

}  // namespace

const tinygltf::Accessor& Accessors::get(int accessor) const {
  file_.require("accessors", static_cast<std::size_t>(accessor));
  return file_.model.accessors[static_cast<std::size_t>(accessor)];
}

std::size_t Accessors::count(int accessor) const { return dense(accessor).count; }

int Accessors::width(int accessor) const {
  return tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(get(accessor).type));
}

Accessors::Source Accessors::window(const std::string& place, int view_index, std::uint64_t offset, std::size_t count,
                                    std::size_t element, std::size_t component) const {
  const auto slot = static_cast<std::size_t>(view_index);
  const BufferView view = file_.bytes->view(file_, slot);
  if ((view.offset + offset) % component != 0) {
    file_.fail(place, "its data is not aligned to " + std::to_string(component) + " bytes");
  }
  const std::uint64_t stride = view.stride == 0 ? element : view.stride;
  if (stride < element) {
    file_.fail(place, "byteStride " + std::to_string(stride) + " is smaller than an element of " +
                          std::to_string(element) + " bytes");
  }
  if (stride % component != 0) file_.fail(place, "byteStride is not a multiple of the component's size");
  // count ≤ 2^40 and stride ≤ 252 by the checks before this one: no overflow.
  if (offset > view.bytes.size() || (count - 1) * stride + element > view.bytes.size() - offset) {
    file_.fail(place, std::to_string(count) + " elements end outside " + at("bufferViews", slot) + " of " +
                          std::to_string(view.bytes.size()) + " bytes");
  }
  return {view.bytes.data() + offset, static_cast<std::size_t>(stride), count};
}

const DecodedElements* Accessors::decoded_elements(int index) const {
  if (decoded_ == nullptr) return nullptr;
  const auto found = decoded_->find(index);
  return found == decoded_->end() ? nullptr : &found->second;
}

Accessors::Source Accessors::dense(int index) const {
  const tinygltf::Accessor& accessor = get(index);
  const std::string place = accessor_name(index);
  const std::uint64_t most = std::max<std::uint64_t>(file_.limits.vertices, 3 * file_.limits.triangles);
  if (accessor.count > most) file_.over_limit(place, "has more than " + std::to_string(most) + " elements");
  const std::size_t component = component_size(accessor.componentType);
  if (component == 0)
    file_.fail(place + ".componentType", std::to_string(accessor.componentType) + " is none of glTF's");
  if (const DecodedElements* decoded = decoded_elements(index)) {
    const std::size_t element = component * static_cast<std::size_t>(width(index));
    if (decoded->bytes.size() != element * decoded->count) file_.fail(place, "was decoded to another size");
    return {decoded->bytes.data(), element, decoded->count};
  }
  if (accessor.bufferView < 0) return {nullptr, 0, accessor.count};
  return window(place, accessor.bufferView, accessor.byteOffset, accessor.count,
                component * static_cast<std::size_t>(width(index)), component);
}

Accessors::Source Accessors::dense(int index, int width, const std::string& use) const {
  if (this->width(index) != width) {
    file_.fail(accessor_name(index), "as " + use + " must have " + std::to_string(width) + " components, not " +
                                         std::to_string(this->width(index)));
  }
  return dense(index);
}

std::vector<std::uint32_t> Accessors::sparse_indices(int index) const {
  const auto& sparse = get(index).sparse;
  const std::string place = accessor_name(index) + ".sparse";
  const int type = sparse.indices.componentType;
  if (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE && type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
      type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT) {
    file_.fail(place + ".indices.componentType", "must be an unsigned integer type");
  }
  const auto count = static_cast<std::size_t>(sparse.count);
  if (count > get(index).count) file_.fail(place + ".count", "is larger than the accessor's own");
  const std::size_t size = component_size(type);
  const Source source = window(place + ".indices", sparse.indices.bufferView,
                               static_cast<std::uint64_t>(sparse.indices.byteOffset), count, size, size);
  std::vector<std::uint32_t> indices(count);
  gather(type, source.data, source.stride, count, 1, false, indices.data());
  for (std::size_t i = 0; i < count; ++i) {
    if (indices[i] >= get(index).count)
      file_.fail(place + ".indices", "index " + std::to_string(indices[i]) + " is outside the accessor");
    if (i > 0 && indices[i] <= indices[i - 1]) file_.fail(place + ".indices", "are not strictly increasing");
  }
  return indices;
}

template <class T>
void Accessors::overlay_sparse(int index, int width, std::vector<T>& values) const {
  const tinygltf::Accessor& accessor = get(index);
  if (!accessor.sparse.isSparse || decoded_elements(index) != nullptr) return;
  const std::vector<std::uint32_t> indices = sparse_indices(index);
  const std::size_t component = component_size(accessor.componentType);
  const auto wide = static_cast<std::size_t>(width);
  const Source source = window(accessor_name(index) + ".sparse.values", accessor.sparse.values.bufferView,
                               static_cast<std::uint64_t>(accessor.sparse.values.byteOffset), indices.size(),
                               component * wide, component);
  std::vector<T> replaced(indices.size() * wide);
  gather(accessor.componentType, source.data, source.stride, indices.size(), width, accessor.normalized,
         replaced.data());
  for (std::size_t i = 0; i < indices.size(); ++i) {
    std::copy_n(replaced.begin() + static_cast<std::ptrdiff_t>(i * wide), wide,
                values.begin() + static_cast<std::ptrdiff_t>(indices[i] * wide));
  }
}

std::vector<float> Accessors::floats(int index, int width, Components allowed, const std::string& use) const {
  const tinygltf::Accessor& accessor = get(index);
  const int type = accessor.componentType;
  const bool is_float = type == TINYGLTF_COMPONENT_TYPE_FLOAT;
  const bool is_small = component_size(type) == 1 || component_size(type) == 2;
  const bool right = is_float || (is_small && allowed == Components::floats_quantized) ||
                     (is_small && accessor.normalized && allowed == Components::floats_normalized);
  if (!right) {
    file_.fail(accessor_name(index),
               "as " + use + " cannot be " + (accessor.normalized ? "normalized " : "") + type_name(type));
  }
  const Source source = dense(index, width, use);
  std::vector<float> values(source.count * static_cast<std::size_t>(width));
  if (source.data) gather(type, source.data, source.stride, source.count, width, accessor.normalized, values.data());
  overlay_sparse(index, width, values);
  if (is_float) check_finite(index, width, values, use);
  return values;
}

std::vector<std::uint32_t> Accessors::integers(int index, int width, bool allow_32, const std::string& use) const {
  const tinygltf::Accessor& accessor = get(index);
  const int type = accessor.componentType;
  const bool right = !accessor.normalized &&
                     (type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
                      (allow_32 && type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT));
  if (!right) {
    file_.fail(accessor_name(index),
               "as " + use + " cannot be " + (accessor.normalized ? "normalized " : "") + type_name(type));
  }
  const Source source = dense(index, width, use);
  std::vector<std::uint32_t> values(source.count * static_cast<std::size_t>(width));
  if (source.data) gather(type, source.data, source.stride, source.count, width, false, values.data());
  overlay_sparse(index, width, values);
  return values;
}

void Accessors::check_finite(int index, int width, const std::vector<float>& values, const std::string& use) const {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) {
      file_.fail(accessor_name(index), "as " + use + " holds a value that is not finite, in element " +
                                           std::to_string(i / static_cast<std::size_t>(width)));
    }
  }
}

}  // namespace sheaf
