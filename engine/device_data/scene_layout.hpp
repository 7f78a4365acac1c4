// SPDX-License-Identifier: MIT
// How a scene lies in the device's buffers: instances in a fixed order, their triangles one after the other (the
// triangle ids of ties, dumps and the visibility buffer), vertices once a mesh, one object hierarchy a mesh copied for
// each instance, the top level over parts of these in front of them.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "device_data/features.hpp"
#include "device_data/scene_parts.hpp"
#include "hierarchy/object_hierarchy.hpp"
#include "interface/shared.h"
#include "scene/scene.hpp"

namespace sheaf {

struct InstanceSource {
  std::uint32_t node = 0, mesh = 0;
  glm::dmat4 within_node{1};  // EXT_mesh_gpu_instancing, and the mesh's centre
  SurfaceRank rank;           // among what lies in the same place
  bool deforms = false;       // skinned or morphed: its vertices are made on the device
};

struct SceneLayout {
  std::vector<InstanceSource> sources;
  std::vector<gpu::Instance> instances;  // the parts that do not change; transforms are filled in a frame
  std::vector<std::uint32_t> indices;
  std::vector<glm::vec3> positions, normals;
  std::vector<glm::vec4> tangents, colors;
  std::vector<glm::vec2> uvs;
  std::vector<gpu::Material> materials;
  std::vector<std::uint32_t> texels;
  std::vector<gpu::Deform> deforms;   // of the deforming instances, in their order
  std::vector<std::uint32_t> joints;  // 12 words a skinned vertex: 4 of joint pairs, 8 of weights
  std::vector<glm::vec3> morphs;
  std::uint32_t dynamic_vertices = 0, skin_matrices = 0, morph_weights = 0;
  std::uint64_t triangles = 0;
  bool face_tangents = false;                // some deforming mesh has them
  bool morphed_attributes = false;           // some have texture coordinates or colors that are morphed
  bool mirrored_skins = false;               // some skin may have a joint that mirrors
  double rank_extent = 0;                    // Coincidence::extent
  std::vector<std::uint32_t> node_children;  // WIDE words per node; the first `top_nodes` are the top level's
  std::vector<std::vector<std::uint32_t>> refit_by_height;  // of the instances' nodes that a part holds
  std::vector<std::uint32_t> node_instance;                 // a node (past the top level): its instance
  std::uint32_t top_nodes = 1;
  std::vector<ScenePart> parts;  // what the top level is built over; children numbered as in node_children
  std::vector<Box> mesh_boxes;   // a mesh: object space, rest pose
};

/// Throws Error{limit} where the scene does not fit the device's buffers.
[[nodiscard]] SceneLayout lay_out(const Scene& scene, const RenderSettings& settings, const Coincidence& coincidence);

}  // namespace sheaf
