// SPDX-License-Identifier: MIT
#include "scene/gltf_file.hpp"

#include <algorithm>
#include <array>
#include <exception>
#include <string_view>
#include <utility>

#include "scene/gltf_container.hpp"
#include "scene/gltf_schema.hpp"
#include "scene/scene_folder.hpp"
#include "scene/sha256.hpp"

namespace sheaf {
namespace {

constexpr std::array<std::string_view, 9> supported_extensions = {"KHR_materials_emissive_strength",
                                                                  "KHR_materials_unlit",
                                                                  "KHR_materials_transmission",
                                                                  "KHR_materials_ior",
                                                                  "KHR_materials_volume",
                                                                  "KHR_texture_transform",
                                                                  "KHR_lights_punctual",
                                                                  "KHR_mesh_quantization",
                                                                  "EXT_mesh_gpu_instancing"};

bool is_supported(const std::string& name) {
  return std::find(supported_extensions.begin(), supported_extensions.end(), name) != supported_extensions.end();
}

void check_extensions(GltfFile& file) {
  if (const nlohmann::json* required = member(file.json, "extensionsRequired")) {
    for (const auto& name : *required) {
      if (!is_supported(name.get<std::string>())) {
        file.fail("extensionsRequired", in_quotes(name.get<std::string>()) + " is not supported");
      }
    }
  }
  if (const nlohmann::json* used = member(file.json, "extensionsUsed")) {
    for (const auto& entry : *used) {
      const auto name = entry.get<std::string>();
      if (is_supported(name) || std::ranges::count(file.extensions_ignored, name) > 0) continue;
      file.extensions_ignored.push_back(name);
      file.warn("extensionsUsed", in_quotes(name) + " is not supported and is ignored");
    }
  }
}

// What tinygltf asks for while it reads: files beside the scene, and a place for images' bytes.
struct Callbacks {
  SceneFolder& folder;
  std::exception_ptr error;  // tinygltf passes over an image that it cannot read: kept to be thrown
};

bool file_exists(const std::string& name, void* user) { return static_cast<Callbacks*>(user)->folder.holds(name); }

std::string same_path(const std::string& name, void*) { return name; }

bool read_whole_file(std::vector<unsigned char>* out, std::string* err, const std::string& name, void* user) {
  try {
    *out = static_cast<Callbacks*>(user)->folder.read(name);
    return true;
  } catch (const Error& error) {
    *err = error.what();
    static_cast<Callbacks*>(user)->error = std::current_exception();
    return false;
  }
}

[[maybe_unused]] bool file_size(std::size_t* size, std::string*, const std::string& name, void* user) {
  *size = static_cast<Callbacks*>(user)->folder.size_of(name);
  return true;
}

bool write_nothing(std::string* err, const std::string&, const std::vector<unsigned char>&, void*) {
  *err = "writing is not allowed";
  return false;
}

// tinygltf 2.9 added a size callback and insists on having it.
template <class T>
void set_size_callback(T& callbacks) {
  if constexpr (requires { callbacks.GetFileSizeInBytes; }) callbacks.GetFileSizeInBytes = &file_size;
}

// Images are decoded later, in parallel, and only those that a material uses.
bool keep_encoded(tinygltf::Image* image, int, std::string*, std::string*, int, int, const unsigned char* bytes,
                  int size, void*) {
  image->image.assign(bytes, bytes + size);
  image->as_is = true;
  return true;
}

// tinygltf quotes whole data URIs in its messages and gives several lines: the first one says what failed.
std::string first_line(const std::string& text) {
  std::string line = text.substr(0, text.find('\n'));
  if (line.size() > 200) line = line.substr(0, 200) + "...";
  std::replace_if(
      line.begin(), line.end(), [](unsigned char c) { return c < 0x20; }, ' ');
  return line.empty() ? "is not a valid glTF file" : line;
}

void read_model(GltfFile& file, SceneFolder& folder, const std::vector<std::uint8_t>& bytes, bool binary) {
  Callbacks callbacks{folder, {}};
  tinygltf::FsCallbacks fs{};
  fs.FileExists = &file_exists;
  fs.ExpandFilePath = &same_path;
  fs.ReadWholeFile = &read_whole_file;
  fs.WriteWholeFile = &write_nothing;
  set_size_callback(fs);
  fs.user_data = &callbacks;

  tinygltf::TinyGLTF reader;
  reader.SetFsCallbacks(fs);
  reader.SetImageLoader(&keep_encoded, nullptr);
  std::string err, warn;
  const auto size = static_cast<unsigned>(bytes.size());
  const bool read = binary
                        ? reader.LoadBinaryFromMemory(&file.model, &err, &warn, bytes.data(), size, folder.path())
                        : reader.LoadASCIIFromString(&file.model, &err, &warn,
                                                     reinterpret_cast<const char*>(bytes.data()), size, folder.path());
  if (callbacks.error) std::rethrow_exception(callbacks.error);
  if (!read) throw input_error(file.path, first_line(err));
}

// The rest of the loader names objects by their index in the JSON, so nothing may have been dropped on the way.
void check_same_objects(const GltfFile& file) {
  const auto same = [&](const char* key, std::size_t count) {
    const nlohmann::json* list = member(file.json, key);
    if ((list ? list->size() : 0) != count) file.fail(key, "could not be read whole");
  };
  same("accessors", file.model.accessors.size());
  same("bufferViews", file.model.bufferViews.size());
  same("buffers", file.model.buffers.size());
  same("meshes", file.model.meshes.size());
  same("nodes", file.model.nodes.size());
  same("materials", file.model.materials.size());
  same("textures", file.model.textures.size());
  same("images", file.model.images.size());
  same("skins", file.model.skins.size());
  same("cameras", file.model.cameras.size());
  same("animations", file.model.animations.size());
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
  const std::vector<std::uint8_t> bytes = folder.read_scene();
  file.sha256 = sha256_hex(bytes);

  const GltfContainer container = check_container(bytes, path);
  file.json = parse_json(container.json, path);
  check_gltf_document(file.json, path);
  check_extensions(file);
  folder.check_references(file.json, container.binary.size());
  read_model(file, folder, bytes, container.is_binary);
  check_same_objects(file);
  return file;
}

}  // namespace sheaf
