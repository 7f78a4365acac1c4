// SPDX-License-Identifier: MIT
#include "scene/gltf_meshopt.hpp"

#include <algorithm>
#include <initializer_list>
#include <string_view>

#include "scene/gltf_file.hpp"
#include "scene/meshopt.hpp"

namespace sheaf {
namespace {

using nlohmann::json;

constexpr const char* khr_name = "KHR_meshopt_compression";
constexpr const char* ext_name = "EXT_meshopt_compression";

struct Layout {
  meshopt::Mode mode = meshopt::Mode::attributes;
  meshopt::Filter filter = meshopt::Filter::none;
  std::uint64_t count = 0, stride = 0;
};

class LayoutReader {
 public:
  LayoutReader(const GltfFile& file, std::string place, const json& object)
      : file_(file), place_(std::move(place)), object_(object) {}

  [[nodiscard]] Layout read() const {
    Layout layout;
    layout.mode = static_cast<meshopt::Mode>(choice("mode", {"ATTRIBUTES", "TRIANGLES", "INDICES"}));
    layout.filter =
        static_cast<meshopt::Filter>(choice("filter", {"NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL", "COLOR"}));
    layout.count = object_.at("count").get<std::uint64_t>();
    layout.stride = object_.at("byteStride").get<std::uint64_t>();
    check(layout);
    return layout;
  }

 private:
  [[nodiscard]] std::size_t choice(const char* key, std::initializer_list<std::string_view> names) const {
    const json* value = member(object_, key);
    if (value == nullptr) return 0;
    const auto& text = value->get_ref<const std::string&>();
    if (const auto* found = std::ranges::find(names, text); found != names.end())
      return static_cast<std::size_t>(found - names.begin());
    file_.fail(place_ + "." + key, in_quotes(text) + " is unknown");
  }

  void check(const Layout& layout) const {
    const std::uint64_t stride = layout.stride;
    const bool is_attributes = layout.mode == meshopt::Mode::attributes;
    const auto want = [&](bool right, const std::string& what) {
      if (!right) file_.fail(place_ + ".byteStride", std::to_string(stride) + " must be " + what);
    };
    if (is_attributes) want(stride % 4 == 0 && stride >= 4 && stride <= 256, "a multiple of 4, at most 256");
    if (!is_attributes) want(stride == 2 || stride == 4, "2 or 4 for indices");
    if (layout.mode == meshopt::Mode::triangles && layout.count % 3 != 0)
      file_.fail(place_ + ".count", std::to_string(layout.count) + " is not a multiple of 3");
    if (!is_attributes && layout.filter != meshopt::Filter::none)
      file_.fail(place_ + ".filter", "must be NONE for indices");
    if (layout.filter == meshopt::Filter::quaternion) want(stride == 8, "8 for the filter QUATERNION");
    if (layout.filter == meshopt::Filter::octahedral || layout.filter == meshopt::Filter::color)
      want(stride == 4 || stride == 8, "4 or 8 for this filter");
  }

  const GltfFile& file_;
  std::string place_;
  const json& object_;
};

bool decode(const Layout& layout, std::span<const std::uint8_t> stream, std::span<std::uint8_t> out) {
  if (layout.mode == meshopt::Mode::triangles) return meshopt::decode_triangles(stream, layout.stride, out);
  if (layout.mode == meshopt::Mode::indices) return meshopt::decode_indices(stream, layout.stride, out);
  if (!meshopt::decode_attributes(stream, layout.stride, out)) return false;
  meshopt::apply_filter(layout.filter, layout.stride, out);
  return true;
}

}  // namespace

PackedView packed_view(const json& view) {
  for (const char* name : {khr_name, ext_name})
    if (const json* object = extension(view, name)) return {name, object};
  return {};
}

std::vector<std::uint8_t> unpack_view(const GltfFile& file, std::size_t index, const PackedView& packed,
                                      std::span<const std::uint8_t> stream, std::uint64_t& budget) {
  const json& view = file.json.at("bufferViews").at(index);
  const std::string place = at("bufferViews", index) + "." + packed.extension;
  const Layout layout = LayoutReader(file, place, *packed.object).read();
  const std::uint64_t size = layout.count * layout.stride;  // at most 2^53 · 2^8
  if (stream.size() < meshopt::least_bytes(layout.mode, layout.count, layout.stride))
    file.fail(place, std::to_string(stream.size()) + " bytes cannot hold " + std::to_string(layout.count) +
                         " elements of " + std::to_string(layout.stride) + " bytes");
  if (size > budget)
    file.over_limit(place, "what is compressed has more than " + std::to_string(file.limits.file_bytes) + " bytes");
  budget -= size;
  if (const auto said = view.at("byteLength").get<std::uint64_t>(); said != size)
    file.warn(place,
              "holds " + std::to_string(size) + " bytes, the bufferView's byteLength says " + std::to_string(said));
  if (packed.extension == ext_name &&
      (stream.front() == meshopt::attributes_version_1 || layout.filter == meshopt::Filter::color))
    file.warn(place, std::string("is written as only ") + khr_name + " allows");
  if (packed.extension == khr_name && extension(view, ext_name) != nullptr)
    file.warn(place, std::string("is used, and ") + ext_name + " beside it is ignored");
  std::vector<std::uint8_t> out(size);
  if (!decode(layout, stream, out)) file.fail(place, "the compressed data is damaged");
  return out;
}

}  // namespace sheaf
