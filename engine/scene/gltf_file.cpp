// SPDX-License-Identifier: MIT
#include "scene/gltf_file.hpp"

#include <limits>
#include <map>
#include <utility>

#include "core/quote.hpp"
#include "scene/gltf_container.hpp"
#include "scene/gltf_extensions.hpp"
#include "scene/gltf_mend.hpp"
#include "scene/gltf_schema.hpp"
#include "scene/scene_folder.hpp"

namespace sheaf {
namespace {

// tinygltf gives several lines: the first one says what failed.
std::string first_line(const std::string& text) {
  const std::string line = quote(text.substr(0, text.find('\n')));
  return line.empty() ? "is not a valid glTF file" : line;
}

// Takes properties out of a document for as long as it lives.
class Without {
 public:
  explicit Without(nlohmann::json& document) : document_(document) {
    for (const char* key : {"buffers", "bufferViews", "images", "cameras", "animations", "extensions"}) {
      const auto found = document_.find(key);
      if (found == document_.end()) continue;
      kept_[key] = std::move(*found);
      document_.erase(found);
    }
  }
  ~Without() {
    for (auto& [key, value] : kept_) document_[key] = std::move(value);
  }
  Without(const Without&) = delete;
  Without& operator=(const Without&) = delete;

 private:
  nlohmann::json& document_;
  std::map<std::string, nlohmann::json> kept_;
};

// Compressed primitives: a tinygltf that was built with Draco would decompress them by itself.
class WithoutPrimitiveExtensions {
 public:
  explicit WithoutPrimitiveExtensions(nlohmann::json& document) : document_(document) {
    each([&](nlohmann::json& primitive) {
      nlohmann::json& kept = kept_.emplace_back();
      const auto found = primitive.find("extensions");
      if (found == primitive.end()) return;
      kept = std::move(*found);
      primitive.erase(found);
    });
  }
  ~WithoutPrimitiveExtensions() {
    auto kept = kept_.begin();
    each([&](nlohmann::json& primitive) {
      if (!kept->is_null()) primitive["extensions"] = std::move(*kept);
      ++kept;
    });
  }
  WithoutPrimitiveExtensions(const WithoutPrimitiveExtensions&) = delete;
  WithoutPrimitiveExtensions& operator=(const WithoutPrimitiveExtensions&) = delete;

 private:
  template <class Change>
  void each(const Change& change) {
    const auto meshes = document_.find("meshes");
    if (meshes == document_.end()) return;
    for (auto& mesh : *meshes)
      for (auto& primitive : mesh["primitives"]) change(primitive);
  }

  nlohmann::json& document_;
  std::vector<nlohmann::json> kept_;
};

// Indices are put where they belong afterwards: tinygltf refuses those of accessors without a bufferView.
std::vector<std::vector<int>> take_indices(nlohmann::json& document) {
  std::vector<std::vector<int>> all;
  for (auto& mesh : document["meshes"]) {
    std::vector<int>& of_mesh = all.emplace_back();
    for (auto& primitive : mesh["primitives"]) {
      const auto indices = primitive.find("indices");
      of_mesh.push_back(indices == primitive.end() ? -1 : indices->get<int>());
      if (indices != primitive.end()) primitive.erase(indices);
    }
  }
  return all;
}

// tinygltf reads only text, so it is given the document as it was checked and mended. What the loader reads from the
// JSON is left out, so that no property has two readers: buffers, their views and images (GltfBytes reads only files
// that lie in the scene's folder), cameras, animations and lights.
void read_model(GltfFile& file) {
  const Without without(file.json);
  const WithoutPrimitiveExtensions without_extensions(file.json);
  const std::vector<std::vector<int>> indices = take_indices(file.json);
  const std::string text = file.json.dump();
  if (text.size() > std::numeric_limits<unsigned>::max()) throw limit_error(file.path, "is larger than 4 GiB");
  tinygltf::TinyGLTF reader;
  std::string err, warn;
  if (!reader.LoadASCIIFromString(&file.model, &err, &warn, text.data(), static_cast<unsigned>(text.size()), ""))
    throw input_error(file.path, first_line(err));
  for (std::size_t m = 0; m < indices.size() && m < file.model.meshes.size(); ++m) {
    std::vector<tinygltf::Primitive>& primitives = file.model.meshes[m].primitives;
    for (std::size_t p = 0; p < indices[m].size() && p < primitives.size(); ++p) primitives[p].indices = indices[m][p];
  }
}

// The rest of the loader names objects by their index in the JSON, so nothing may have been dropped on the way.
void check_same_objects(const GltfFile& file) {
  const auto same = [&](const char* key, std::size_t count) {
    const nlohmann::json* list = member(file.json, key);
    if ((list ? list->size() : 0) != count) file.fail(key, "could not be read whole");
  };
  same("accessors", file.model.accessors.size());
  same("meshes", file.model.meshes.size());
  same("nodes", file.model.nodes.size());
  same("materials", file.model.materials.size());
  same("textures", file.model.textures.size());
  same("skins", file.model.skins.size());
  for (std::size_t m = 0; m < file.model.meshes.size(); ++m) {
    if (file.model.meshes[m].primitives.size() != file.json["meshes"][m]["primitives"].size()) {
      file.fail(at("meshes", m), "could not be read whole");
    }
  }
}

}  // namespace

GltfFile open_gltf(const std::string& path, const LoadLimits& limits) {
  GltfFile file;
  file.path = path;
  file.limits = limits;
  SceneFolder folder(path, limits.file_bytes);
  std::vector<std::uint8_t> bytes = folder.read_scene();

  const GltfContainer container = check_container(bytes, path);
  for (const std::string& oddity : container.oddities) file.warn("file", oddity);
  file.json = parse_json(container.json, path);
  mend_document(file.json, file.warnings);
  file.broken = check_gltf_document(file.json, path);
  check_extensions(file);
  file.bytes = std::make_unique<GltfBytes>(std::move(folder), std::move(bytes), container.binary);
  read_model(file);
  check_same_objects(file);
  return file;
}

}  // namespace sheaf
