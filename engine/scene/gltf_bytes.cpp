// SPDX-License-Identifier: MIT
#include "scene/gltf_bytes.hpp"

#include <algorithm>
#include <limits>

#include "scene/data_uri.hpp"
#include "scene/gltf_file.hpp"
#include "scene/gltf_meshopt.hpp"

namespace sheaf {
namespace {

using nlohmann::json;

struct Range {
  std::size_t buffer = 0;
  std::uint64_t offset = 0, length = 0;
  [[nodiscard]] bool within(std::uint64_t size) const { return offset <= size && length <= size - offset; }
  [[nodiscard]] std::string outside(std::uint64_t size) const {
    return "bytes " + std::to_string(offset) + " to " + std::to_string(offset + length) + " are outside " +
           at("buffers", buffer) + " of " + std::to_string(size) + " bytes";
  }
};

// Of a bufferView, or of the extension that says where its compressed bytes are.
Range range_of(const json& view) {  // each number is at most 2^53: no sum overflows
  return {view.at("buffer").get<std::size_t>(), view.value("byteOffset", std::uint64_t{0}),
          view.at("byteLength").get<std::uint64_t>()};
}

}  // namespace

std::vector<std::uint8_t> GltfBytes::from_uri(const GltfFile& file, const std::string& uri, const std::string& place,
                                              std::uint64_t most) {
  if (is_data_uri(uri)) {
    DataUri data = read_data_uri(uri);
    if (!data.fault.empty()) file.fail(place, data.fault);
    if (!data.oddity.empty()) file.warn(place, data.oddity);
    return std::move(data.bytes);
  }
  const Located located = folder_.locate(uri);
  if (!located.fault.empty()) file.fail(place, located.fault);
  if (!located.oddity.empty()) file.warn(place, located.oddity);
  return folder_.read(located.path, most);
}

// How much of each buffer's resource may be needed: what it says, or what its views reach to where that is more. A
// compressed view needs nothing of the buffer that holds the same uncompressed.
void GltfBytes::find_reach(const GltfFile& file) {
  const json& buffers = file.json.at("buffers");
  for (const json& one : buffers) reach_.push_back(one.at("byteLength").get<std::uint64_t>());
  for (const json& view : file.json.at("bufferViews")) {
    const PackedView packed = packed_view(view);
    const Range range = range_of(packed ? *packed.object : view);
    if (range.buffer < reach_.size())
      reach_[range.buffer] = std::max(reach_[range.buffer], range.offset + range.length);
  }
}

std::span<const std::uint8_t> GltfBytes::buffer(const GltfFile& file, std::size_t index) {
  if (const auto known = buffers_.find(index); known != buffers_.end()) return known->second.bytes;
  file.require("buffers", index);
  if (reach_.empty()) find_reach(file);
  const json& object = file.json.at("buffers").at(index);
  const std::string place = at("buffers", index);
  const auto length = object.at("byteLength").get<std::uint64_t>();
  const json* uri = member(object, "uri");
  const bool is_data = uri && is_data_uri(uri->get_ref<const std::string&>());
  Resource resource;
  if (uri) {
    resource.own = from_uri(file, uri->get_ref<const std::string&>(), place + ".uri", reach_[index]);
    resource.bytes = resource.own;
  } else if (index == 0 && !binary_.empty()) {
    resource.bytes = binary_;
  } else {
    file.fail(place, "has no uri");
  }
  const std::uint64_t size = resource.bytes.size();
  // A chunk is padded to four bytes, and a file may hold more than one buffer; base64 has no reason for either.
  if (size < length || (is_data && size > length)) {
    const std::string what = is_data ? "its data URI" : uri ? "its file" : "its BIN chunk";
    file.warn(place, what + " holds " + std::to_string(size) + " bytes, byteLength says " + std::to_string(length));
  }
  return buffers_.emplace(index, std::move(resource)).first->second.bytes;
}

std::span<const std::uint8_t> GltfBytes::range(const GltfFile& file, const json& object, const std::string& place,
                                               bool is_new) {
  const Range range = range_of(object);
  const std::span<const std::uint8_t> bytes = buffer(file, range.buffer);
  if (!range.within(bytes.size())) file.fail(place, range.outside(bytes.size()));
  const auto length = file.json.at("buffers").at(range.buffer).at("byteLength").get<std::uint64_t>();
  if (is_new && !range.within(length) && bytes.size() > length)
    file.warn(place, range.outside(length) + ", but not of what was read");
  return bytes.subspan(range.offset, range.length);
}

BufferView GltfBytes::view(const GltfFile& file, std::size_t index) {
  file.require("bufferViews", index);
  const json& object = file.json.at("bufferViews").at(index);
  const bool is_new = views_.insert(index).second;
  const std::string place = at("bufferViews", index);
  const std::uint64_t offset = object.value("byteOffset", std::uint64_t{0});
  const std::uint64_t stride = object.value("byteStride", std::uint64_t{0});
  const PackedView packed = packed_view(object);
  if (!packed) return {range(file, object, place, is_new), offset, stride};
  if (const auto known = unpacked_.find(index); known != unpacked_.end()) return {known->second, offset, stride};
  if (unpacked_.empty()) unpack_budget_ = file.limits.file_bytes;
  const auto stream = range(file, *packed.object, place + "." + packed.extension, true);
  return {unpacked_.emplace(index, unpack_view(file, index, packed, stream, unpack_budget_)).first->second, offset,
          stride};
}

std::span<const std::uint8_t> GltfBytes::image(const GltfFile& file, std::size_t index) {
  if (const auto known = images_.find(index); known != images_.end()) return known->second.bytes;
  file.require("images", index);
  Resource resource;
  const json& object = file.json.at("images").at(index);
  if (const json* uri = member(object, "uri")) {
    resource.own = from_uri(file, uri->get_ref<const std::string&>(), at("images", index) + ".uri",
                            std::numeric_limits<std::uint64_t>::max());
    resource.bytes = resource.own;
  } else if (const json* view_index = member(object, "bufferView")) {
    resource.bytes = view(file, view_index->get<std::size_t>()).bytes;
  } else {
    file.fail(at("images", index), "has neither uri nor bufferView");
  }
  return images_.emplace(index, std::move(resource)).first->second.bytes;
}

void GltfBytes::report_uri(const GltfFile& file, const std::string& collection, std::size_t index) const {
  const std::string place = at(collection.c_str(), index);
  const json* uri = member(file.json.at(collection).at(index), "uri");
  if (!uri || is_data_uri(uri->get_ref<const std::string&>())) return;
  const Located located = folder_.locate(uri->get_ref<const std::string&>());
  if (!located.fault.empty()) file.warn(place + ".uri", located.fault + ", but nothing uses it");
}

void GltfBytes::report_unused(const GltfFile& file) const {
  constexpr std::size_t most = 1000;  // files looked for: a warning is a courtesy
  for (const auto& [collection, used] : {std::pair{"buffers", &buffers_}, std::pair{"images", &images_}}) {
    const json* list = member(file.json, collection);
    for (std::size_t i = 0; list && i < std::min(list->size(), most); ++i)
      if (!used->contains(i) && !file.broken.find(collection, i)) report_uri(file, collection, i);
  }
  const json* views = member(file.json, "bufferViews");
  for (std::size_t i = 0; views && i < views->size(); ++i) {
    if (views_.contains(i) || file.broken.find("bufferViews", i)) continue;
    const PackedView packed = packed_view((*views)[i]);
    const Range range = range_of(packed ? *packed.object : (*views)[i]);
    const auto length = file.json.at("buffers").at(range.buffer).at("byteLength").get<std::uint64_t>();
    if (!range.within(length)) file.warn(at("bufferViews", i), range.outside(length) + ", but nothing uses it");
  }
}

}  // namespace sheaf
