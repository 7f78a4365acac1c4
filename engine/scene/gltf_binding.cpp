// SPDX-License-Identifier: MIT
// Nodes tied to meshes: skins, rest weights, instances.
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>

#include "scene/gltf_nodes.hpp"

namespace sheaf {
namespace {

Skin read_skin(const GltfFile& file, const Accessors& accessors, std::size_t index) {
  file.require("skins", index);
  const tinygltf::Skin& source = file.model.skins[index];
  const std::string place = at("skins", index);
  Skin skin;
  skin.joints.assign(source.joints.begin(), source.joints.end());
  if (skin.joints.empty()) file.fail(place + ".joints", "is empty");
  for (const std::uint32_t joint : skin.joints) file.require("nodes", joint);
  if (skin.joints.size() > 65536) file.over_limit(place + ".joints", "has more than 65536 joints");
  skin.inverse_bind.assign(skin.joints.size(), glm::dmat4(1));
  if (source.inverseBindMatrices < 0) return skin;
  const std::vector<float> values =
      accessors.floats(source.inverseBindMatrices, 16, Components::floats, "inverse bind matrices");
  if (values.size() / 16 < skin.joints.size()) {
    file.fail(place, "has " + std::to_string(skin.joints.size()) + " joints and " + std::to_string(values.size() / 16) +
                         " inverse bind matrices");
  }
  for (std::size_t j = 0; j < skin.joints.size(); ++j)
    skin.inverse_bind[j] = glm::dmat4(glm::make_mat4(values.data() + 16 * j));
  return skin;
}

struct Instances {
  std::vector<float> translation, rotation, scale;
  std::size_t count = 0;
};

glm::dmat4 instance_matrix(const Instances& in, std::size_t i) {
  glm::dmat4 m(1);
  if (!in.translation.empty()) m = glm::translate(m, glm::dvec3(glm::make_vec3(&in.translation[3 * i])));
  if (!in.rotation.empty()) {
    const float* r = &in.rotation[4 * i];
    const glm::dquat q(r[3], r[0], r[1], r[2]);
    const double length = glm::length(q);
    if (length > 0) m *= glm::mat4_cast(q / length);
  }
  if (!in.scale.empty()) m = glm::scale(m, glm::dvec3(glm::make_vec3(&in.scale[3 * i])));
  return m;
}

std::vector<glm::dmat4> read_instances(const GltfFile& file, const Accessors& accessors,
                                       const nlohmann::json& attributes, const std::string& place) {
  Instances in;
  const auto read = [&](const char* name, int width, Components allowed) -> std::vector<float> {
    const nlohmann::json* accessor = member(attributes, name);
    if (!accessor) return {};
    const int index = accessor->get<int>();
    if (in.count != 0 && accessors.count(index) != in.count) file.fail(place, "its attributes differ in count");
    in.count = accessors.count(index);
    if (in.count > file.limits.nodes)
      file.over_limit(place, "more than " + std::to_string(file.limits.nodes) + " instances");
    return accessors.floats(index, width, allowed, std::string("instance ") + name);
  };
  in.translation = read("TRANSLATION", 3, Components::floats);
  in.rotation = read("ROTATION", 4, Components::floats_normalized);
  in.scale = read("SCALE", 3, Components::floats);
  std::vector<glm::dmat4> matrices(in.count);
  for (std::size_t i = 0; i < in.count; ++i) matrices[i] = instance_matrix(in, i);
  return matrices;
}

// A joint outside the scene still has a place: that of the nodes it hangs from (glTF 2.0, 3.7.3.2 wants all of a skin's
// joints in the scene). `posed`: the nodes of Scene::order and Scene::outside.
void pose_joints(GltfFile& file, std::uint32_t skin, const std::string& place, Scene& scene, std::vector<bool>& posed) {
  std::uint32_t first = none;
  for (const std::uint32_t joint : scene.skins[skin].joints) {
    const auto at_end = static_cast<std::ptrdiff_t>(scene.outside.size());
    for (std::uint32_t node = joint; node != none && !posed[node]; node = scene.nodes[node].parent) {
      posed[node] = true;
      scene.outside.insert(scene.outside.begin() + at_end, node);
      if (first == none) first = joint;
    }
  }
  if (first == none) return;
  file.warn(place, "joint " + std::to_string(first) + " of " + at("skins", skin) +
                       " is not in the scene; joints outside it are placed by the nodes they hang from");
}

void bind_skin(GltfFile& file, const Accessors& accessors, const MeshEntry& mesh, Scene& scene, std::size_t index,
               Node& node, std::vector<bool>& posed) {
  const int skin = file.model.nodes[index].skin;
  if (skin < 0 || mesh.count == 0) return;
  const std::string place = at("nodes", index);
  if (mesh.joints == 0) {
    file.warn(place + ".skin", "is ignored: the node's mesh has no JOINTS_0");
    return;
  }
  Skin& read = scene.skins[static_cast<std::size_t>(skin)];
  if (read.joints.empty()) read = read_skin(file, accessors, static_cast<std::size_t>(skin));
  const std::size_t joints = read.joints.size();
  if (mesh.joints > joints) {
    file.fail(place, "its mesh refers to joint " + std::to_string(mesh.joints - 1) + ", " +
                         at("skins", static_cast<std::size_t>(skin)) + " has " + std::to_string(joints));
  }
  node.skin = static_cast<std::uint32_t>(skin);
  pose_joints(file, node.skin, place, scene, posed);
}

}  // namespace

void bind_meshes(GltfFile& file, const std::vector<MeshEntry>& meshes, Scene& scene) {
  const Accessors accessors(file);
  scene.skins.resize(file.model.skins.size());  // those that nothing wears stay empty
  std::vector<bool> posed(scene.nodes.size(), false);
  for (const std::uint32_t i : scene.order) posed[i] = true;
  std::uint64_t instances = 0;
  for (const std::uint32_t i : scene.order) {
    const tinygltf::Node& source = file.model.nodes[i];
    Node& node = scene.nodes[i];
    if (source.mesh < 0 || !node.shown) continue;
    const MeshEntry& mesh = meshes[static_cast<std::size_t>(source.mesh)];
    node.first_mesh = mesh.first;
    node.mesh_count = mesh.count;
    node.morph_weights = source.weights.empty() ? mesh.weights : source.weights;
    if (node.morph_weights.size() != mesh.targets) {
      file.fail(at("nodes", i) + ".weights", "has " + std::to_string(node.morph_weights.size()) + " weights for " +
                                                 std::to_string(mesh.targets) + " morph targets");
    }
    bind_skin(file, accessors, mesh, scene, i, node, posed);
    if (const auto* e = extension(file.json["nodes"][i], "EXT_mesh_gpu_instancing")) {
      node.instances =
          read_instances(file, accessors, e->at("attributes"), at("nodes", i) + ".EXT_mesh_gpu_instancing");
      if (node.skin != none) {
        // A skin's joints alone say where its mesh is: the node's own transform, which instances stand in, does not.
        file.warn(at("nodes", i) + ".EXT_mesh_gpu_instancing",
                  "is ignored: the node has a skin, and is drawn once, where its joints are");
        node.instances.clear();
      }
      instances += node.instances.size();
      if (instances > file.limits.nodes)
        file.over_limit(at("nodes", i), "more than " + std::to_string(file.limits.nodes) + " instances");
    }
  }
}

}  // namespace sheaf
