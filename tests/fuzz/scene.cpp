// SPDX-License-Identifier: MIT
// glTF files, and the pose at a few times. The first byte says how the rest is read: 'j': JSON, a zero byte and the
// binary chunk, put together as a .glb whose lengths are right; anything else: a file as it is.
#include <algorithm>
#include <array>
#include <cstring>

#include "core/error.hpp"
#include "json_mutator.hpp"
#include "scene/gltf_loader.hpp"
#include "scene/pose.hpp"
#include "target.hpp"

namespace {

using namespace sheaf;

// Small, so that whatever asks for more than its file justifies shows up as memory.
LoadLimits small_limits() {
  LoadLimits limits;
  limits.file_bytes = 1 << 20;
  limits.triangles = limits.vertices = 200'000;
  limits.nodes = 5000;
  limits.texture_bytes = 16 << 20;
  limits.image_side = 2048;
  return limits;
}

std::string put_together(std::string_view json, std::string_view binary) {
  std::string out = "glTF";
  const auto word = [&out](std::size_t value) {
    for (int shift = 0; shift < 32; shift += 8) out += static_cast<char>(value >> shift & 255);
  };
  const std::size_t text = (json.size() + 3) / 4 * 4, data = (binary.size() + 3) / 4 * 4;
  word(2), word(12 + 8 + text + (data > 0 ? 8 + data : 0)), word(text);
  out += "JSON";
  out.append(json).append(text - json.size(), ' ');
  if (data == 0) return out;
  word(data);
  out += std::string_view("BIN\0", 4);
  return out.append(binary).append(data - binary.size(), '\0');
}

/// A loaded scene is a checked one: whoever walks it need not look again.
void check(const Scene& scene) {
  for (const auto& mesh : scene.meshes)
    for (const auto& triangle : mesh.triangles)
      for (int corner = 0; corner < 3; ++corner)
        fuzz::require(triangle[corner] < mesh.positions.size(), "an index lies within its mesh");
  for (const std::uint32_t node : scene.order)
    fuzz::require(node < scene.nodes.size(), "order names nodes that are there");
  const auto animations = select_animations(scene, scene.animations.empty() ? "" : "all");
  for (const double time : {0.0, 0.37, 1e9})
    fuzz::require(evaluate_pose(scene, animations, time).world.size() == scene.nodes.size(),
                  "every node has its place");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fuzz::Scratch scratch;
  if (size == 0) return 0;
  const std::string_view rest = fuzz::as_text(data + 1, size - 1);
  const auto end = std::min(rest.find('\0'), rest.size());
  const std::string file = data[0] == 'j'
                               ? put_together(rest.substr(0, end), rest.substr(std::min(end + 1, rest.size())))
                               : std::string(rest);
  try {
    check(load_gltf(scratch.file("scene", file), {}, small_limits()));
  } catch (const Error&) {
    // Refused, with a reason.
  }
  return 0;
}

#ifdef SHEAF_FUZZ
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned seed) {
  const auto* const zero = static_cast<const std::uint8_t*>(std::memchr(data, 0, size));
  const std::size_t end = zero ? static_cast<std::size_t>(zero - data) : size;
  if (size < 3 || data[0] != 'j' || seed % 3 == 0) return LLVMFuzzerMutate(data, size, max_size);
  if (seed % 3 == 1 && end + 1 < size)
    return end + 1 + LLVMFuzzerMutate(data + end + 1, size - end - 1, max_size - end - 1);
  const std::string json(reinterpret_cast<const char*>(data) + 1, end - 1);
  const std::string all = "j" + fuzz::mutated_json(json, seed) + std::string(data + end, data + size);
  std::copy_n(all.begin(), std::min(all.size(), max_size), data);
  return std::min(all.size(), max_size);
}
#endif
