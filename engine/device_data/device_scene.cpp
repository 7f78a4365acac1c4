// SPDX-License-Identifier: MIT
#include "device_data/device_scene.hpp"

#include <algorithm>

#include "core/error.hpp"

namespace sheaf {
namespace {

constexpr std::uint32_t max_lights = 4096;

}  // namespace

DeviceScene::DeviceScene(const Device& device, const Scene& scene, const RenderSettings& settings, const Plan& plan)
    : scene_(scene),
      hierarchy_(plan.object_hierarchy),
      transform_on_fetch_(plan.transform_on_fetch),
      layout_(lay_out(scene, settings, plan.coincidence ? *plan.coincidence : Coincidence{})) {
  Recorder recorder(device);
  indices_ = upload(device, recorder, "indices", layout_.indices, by_address);
  positions_ = upload(device, recorder, "positions", layout_.positions, by_address);
  normals_ = upload(device, recorder, "normals", layout_.normals, by_address);
  tangents_ = upload(device, recorder, "tangents", layout_.tangents, by_address);
  uvs_ = upload(device, recorder, "texture coordinates", layout_.uvs, by_address);
  colors_ = upload(device, recorder, "vertex colors", layout_.colors, by_address);
  materials_ = upload(device, recorder, "materials", layout_.materials, by_address);
  texels_ = upload(device, recorder, "texels", layout_.texels, by_address);
  deforms_ = upload(device, recorder, "deforming instances", layout_.deforms);
  joints_ = upload(device, recorder, "joints", layout_.joints);
  morphs_ = upload(device, recorder, "morph targets", layout_.morphs);
  using Kind = Buffer::Kind;
  triangles_ = Buffer(device, "triangles", layout_.triangles * (transform_on_fetch_ ? 1 : gpu::TRIANGLE_WORDS) * 4,
                      Kind::device, by_address);
  instances_ = Buffer(device, "instances", layout_.instances.size() * sizeof(gpu::Instance), Kind::upload, by_address);
  dynamic_ = Buffer(device, "deformed vertices", std::uint64_t{layout_.dynamic_vertices} * 3 * sizeof(glm::vec3),
                    Kind::device, by_address);
  matrices_ = Buffer(device, "joint matrices", std::uint64_t{layout_.skin_matrices} * 12 * 4, Kind::upload);
  weights_ = Buffer(device, "morph weights", std::uint64_t{layout_.morph_weights} * 4, Kind::upload);
  if (hierarchy_) {
    if (layout_.node_children.size() / wide > gpu::MAX_NODES)
      throw limit_error(scene.path, std::to_string(layout_.triangles) + " triangles need more than " +
                                        std::to_string(gpu::MAX_NODES) + " nodes of the object hierarchy");
    std::vector<std::uint32_t> words(layout_.node_children.size() / wide * gpu::NODE_WORDS);
    for (std::size_t n = 0; n < layout_.node_children.size() / wide; ++n)
      std::copy_n(&layout_.node_children[n * wide], wide, &words[n * gpu::NODE_WORDS + gpu::NODE_CHILD]);
    nodes_ = upload(device, recorder, "object hierarchy", words, by_address);
    refit_work_ = Buffer(device, "refit list", layout_.node_children.size() / wide * 4, Kind::upload);
    top_staging_ = Buffer(device, "top level", std::uint64_t{layout_.top_nodes} * gpu::NODE_WORDS * 4, Kind::upload);
  }
  std::uint64_t triangle_blocks = 0, vertex_blocks = 0;
  for (const auto& i : layout_.instances) triangle_blocks += (i.triangle_count + gpu::GROUP - 1) / gpu::GROUP;
  for (const auto& d : layout_.deforms) vertex_blocks += (d.vertex_count + gpu::GROUP - 1) / gpu::GROUP;
  triangle_work_ = Buffer(device, "moved triangles", triangle_blocks * 8, Kind::upload);
  vertex_work_ = Buffer(device, "moved vertices", vertex_blocks * 8, Kind::upload);
  boxes_.resize(layout_.instances.size());
  to_world_.resize(layout_.instances.size(), glm::dmat4(1));

  for (const auto index : scene.order) light_count_ += scene.nodes[index].light != none ? 1 : 0;
  light_count_ = std::max(light_count_, 1U);
  if (light_count_ > max_lights)
    throw limit_error(scene.path, std::to_string(light_count_) + " lights; the most is " + std::to_string(max_lights));
  lights_ = Buffer(device, "lights", light_count_ * sizeof(gpu::Light), Kind::upload, by_address);
  layout_.indices = {};
  layout_.positions = layout_.normals = layout_.morphs = {};
  layout_.texels = layout_.joints = {};
}

void DeviceScene::bind(Recorder& r) const {
  r.bind(ROLE_MATERIALS, materials_);
  r.bind(ROLE_INSTANCES, instances_);
  r.bind(ROLE_LIGHTS, lights_);
  r.bind(ROLE_DYNAMIC, dynamic_);
  r.bind(ROLE_DEFORM, deforms_);
  r.bind(ROLE_JOINTS, joints_);
  r.bind(ROLE_MORPHS, morphs_);
  r.bind(ROLE_JOINT_MATRICES, matrices_);
  r.bind(ROLE_MORPH_WEIGHTS, weights_);
}

void DeviceScene::set_addresses(gpu::Frame& frame) const {
  frame.triangles_at = triangles_.address_words();
  frame.indices_at = indices_.address_words();
  frame.positions_at = positions_.address_words();
  frame.normals_at = normals_.address_words();
  frame.tangents_at = tangents_.address_words();
  frame.uvs_at = uvs_.address_words();
  frame.colors_at = colors_.address_words();
  frame.dynamic_at = dynamic_.address_words();
  frame.texels_at = texels_.address_words();
  frame.instances_at = instances_.address_words();
  frame.materials_at = materials_.address_words();
  frame.lights_at = lights_.address_words();
  if (nodes_) frame.nodes_at = nodes_.address_words();
}

}  // namespace sheaf
