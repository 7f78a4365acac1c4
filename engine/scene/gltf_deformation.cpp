// SPDX-License-Identifier: MIT
#include "scene/gltf_deformation.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <set>

namespace sheaf {
namespace {

constexpr std::uint32_t attribute_limit = 8;  // joints a vertex

void read_influence_set(const PrimitiveReader& in, Mesh& mesh, std::size_t set) {
  const std::string joints_name = "JOINTS_" + std::to_string(set), weights_name = "WEIGHTS_" + std::to_string(set);
  const int joints_at = in.accessor(joints_name.c_str()), weights_at = in.accessor(weights_name.c_str());
  if (joints_at < 0 && weights_at < 0) return;
  if (joints_at < 0 || weights_at < 0)
    in.file.fail(in.place, joints_name + " and " + weights_name + " must come together");
  if (in.accessors.count(joints_at) != in.vertices)
    in.file.fail(in.place, joints_name + " has not as many elements as POSITION");
  const auto joints = in.accessors.integers(joints_at, 4, false, joints_name);
  const auto weights = attribute<glm::vec4>(in, weights_name.c_str(), Components::floats_normalized);
  mesh.joints.resize(in.vertices);
  mesh.weights.resize(in.vertices);
  bool negative = false;
  for (std::size_t v = 0; v < in.vertices; ++v) {
    for (std::size_t c = 0; c < 4; ++c) {
      const float weight = weights[v][static_cast<int>(c)];
      negative = negative || weight < 0;
      if (!(weight > 0)) continue;  // the joint of a weight of zero means nothing: left 0
      mesh.joints[v][set * 4 + c] = static_cast<std::uint16_t>(joints[v * 4 + c]);
      mesh.weights[v][set * 4 + c] = weight;
    }
  }
  if (negative) in.file.warn(in.place, weights_name + " has negative weights, taken as 0");
}

void normalize_weights(const PrimitiveReader& in, Mesh& mesh) {
  bool weightless = false;
  for (auto& weights : mesh.weights) {
    double sum = 0;
    for (const float w : weights) sum += w;
    if (sum > 0) {
      for (float& w : weights) w = static_cast<float>(w / sum);
    } else {
      weights[0] = 1;  // joints[v][0] is 0 then: the skin's first joint
      weightless = true;
    }
  }
  if (weightless) in.file.warn(in.place, "vertices without any weight follow the skin's first joint");
}

// The deltas of one attribute of a target; nothing where it has none, or none that is not 0.
template <class V>
std::vector<V> deltas(const PrimitiveReader& in, const std::map<std::string, int>& target, const std::string& place,
                      const char* name) {
  const auto found = target.find(name);
  if (found == target.end()) return {};
  if (in.accessors.count(found->second) != in.vertices)
    in.file.fail(place, std::string(name) + " has not as many elements as the primitive's POSITION");
  std::vector<V> values;
  bool read = false;
  if constexpr (std::is_same_v<V, glm::vec4>) {
    read = in.accessors.width(found->second) == 3;  // alpha's deltas are 0
    if (read)
      for (const glm::vec3& rgb : deltas<glm::vec3>(in, target, place, name)) values.emplace_back(rgb, 0.0f);
  }
  if (!read)
    values = as_vectors<V>(
        in.accessors.floats(found->second, sizeof(V) / sizeof(float), Components::floats_quantized, name));
  if (std::ranges::all_of(values, [](const V& v) { return v == V(0); })) values.clear();
  return values;
}

// What a target's attribute has no use for: a warning for each primitive, since models have dozens of targets.
void warn_of_unread(const PrimitiveReader& in) {
  static constexpr std::array read{"POSITION", "NORMAL", "TANGENT", "TEXCOORD_0", "TEXCOORD_1", "COLOR_0"};
  std::set<std::string> told;
  for (std::size_t t = 0; t < in.primitive.targets.size(); ++t) {
    for (const auto& [name, accessor] : in.primitive.targets[t]) {
      const bool known = std::ranges::find(read, name) != read.end();
      if (name.starts_with('_') || name == "NORMAL" || name == "TANGENT" || !told.insert(name).second) continue;
      const std::string place = in.place + "." + at("targets", t) + "." + name.substr(0, 40);
      if (!known) {
        told.insert(name);
        in.file.warn(place, "is ignored: POSITION, NORMAL, TANGENT, TEXCOORD_0, TEXCOORD_1 and COLOR_0 are morphed");
      } else if (in.accessor(name.c_str()) < 0) {
        in.file.warn(place, "is ignored: the primitive has no " + name + " for it to change");
      }
    }
  }
}

}  // namespace

void read_skinning(const PrimitiveReader& in, Mesh& mesh) {
  for (std::size_t set = 0; set * 4 < attribute_limit; ++set) read_influence_set(in, mesh, set);
  if (in.accessor("JOINTS_0") < 0 && !mesh.joints.empty()) in.file.fail(in.place, "JOINTS_1 without JOINTS_0");
  if (in.accessor("JOINTS_2") >= 0) in.file.warn(in.place, "more than 8 joints a vertex, JOINTS_2 and on are ignored");
  normalize_weights(in, mesh);
}

void read_targets(const PrimitiveReader& in, Mesh& mesh) {
  for (std::size_t t = 0; t < in.primitive.targets.size(); ++t) {
    const auto& source = in.primitive.targets[t];
    const std::string place = in.place + ".targets[" + std::to_string(t) + "]";
    MorphTarget target;
    target.positions = deltas<glm::vec3>(in, source, place, "POSITION");
    target.normals = deltas<glm::vec3>(in, source, place, "NORMAL");
    target.tangents = deltas<glm::vec3>(in, source, place, "TANGENT");
    if (!mesh.uv0.empty()) target.uv0 = deltas<glm::vec2>(in, source, place, "TEXCOORD_0");
    if (!mesh.uv1.empty()) target.uv1 = deltas<glm::vec2>(in, source, place, "TEXCOORD_1");
    if (!mesh.colors.empty()) target.colors = deltas<glm::vec4>(in, source, place, "COLOR_0");
    mesh.targets.push_back(std::move(target));
  }
  warn_of_unread(in);
}

}  // namespace sheaf
