// SPDX-License-Identifier: MIT
// The scene at a frame's time: what moved is placed, and listed for the stages that animate and refit it.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "device_data/device_scene.hpp"
#include "hierarchy/slot_order.hpp"

namespace sheaf {
namespace {

template <typename T>
bool store(T& place, const T& value) {  // true where the value changed
  // Bits decide: a −0 that became 0 is stored again, which costs nothing.
  // NOLINTNEXTLINE(bugprone-suspicious-memory-comparison)
  if (std::memcmp(&place, &value, sizeof(T)) == 0) return false;
  place = value;
  return true;
}

glm::vec3 row(const glm::dmat4& m, int r) { return glm::vec3(glm::dvec3(m[0][r], m[1][r], m[2][r])); }

// Rows of the cofactor matrix times the determinant's sign: the inverse transpose but for its length, finite for any M.
glm::dmat3 cofactors(const glm::dmat4& m) {
  const glm::dvec3 a(m[0]), b(m[1]), c(m[2]);
  return {glm::cross(b, c), glm::cross(c, a), glm::cross(a, b)};
}

void merge(Box& into, const Box& box) {
  into.lo = glm::min(into.lo, box.lo);
  into.hi = glm::max(into.hi, box.hi);
}

glm::dmat4 translation(const glm::dvec3& t) {
  glm::dmat4 m(1);
  m[3] = glm::dvec4(t, 1);
  return m;
}

bool mirrors(const Skin& skin, const Pose& pose) {
  for (std::size_t j = 0; j < skin.joints.size(); ++j)
    if (glm::determinant(glm::dmat3(pose.world[skin.joints[j]] * skin.inverse_bind[j])) < 0) return true;
  return false;
}

}  // namespace

void DeviceScene::place_instances(const Pose& pose, std::vector<bool>& moved) {
  const auto placed = instances_.view<gpu::Instance>();
  for (std::size_t i = 0; i < layout_.instances.size(); ++i) {
    const InstanceSource& source = layout_.sources[i];
    gpu::Instance instance = layout_.instances[i];
    instance.determinant_sign = 1;
    const bool skinned =
        source.deforms && scene_.nodes[source.node].skin != none && !scene_.meshes[source.mesh].joints.empty();
    if (!skinned) {
      const glm::dmat4 m = translation(-origin_) * pose.world[source.node] * source.within_node;
      instance.row0 = row(m, 0);
      instance.row1 = row(m, 1);
      instance.row2 = row(m, 2);
      instance.translation = glm::vec3(glm::dvec3(m[3]));
      const double sign = glm::determinant(glm::dmat3(m)) < 0 ? -1 : 1;
      instance.determinant_sign = static_cast<float>(sign);
      glm::dmat3 c = cofactors(m);
      const double size = std::max({glm::length(c[0]), glm::length(c[1]), glm::length(c[2]), 1e-300});
      c *= sign / size;
      instance.normal0 = glm::vec3(c[0].x, c[1].x, c[2].x);
      instance.normal1 = glm::vec3(c[0].y, c[1].y, c[2].y);
      instance.normal2 = glm::vec3(c[0].z, c[1].z, c[2].z);
      boxes_[i] = transformed(layout_.mesh_boxes[source.mesh], m);
      to_world_[i] = m;
    } else if ((instance.marks & gpu::INSTANCE_DEFORM) != gpu::INSTANCE_DEFORM &&
               !mirrors(scene_.skins[scene_.nodes[source.node].skin], pose)) {
      instance.marks |= gpu::INSTANCE_DEFORM;
    }
    if (store(placed[i], instance)) moved[i] = true;
  }
}

void DeviceScene::place_skins(const Pose& pose, std::vector<bool>& moved) {
  const auto matrices = matrices_.view<float>();
  const auto weights = weights_.view<float>();
  for (const auto& d : layout_.deforms) {
    const InstanceSource& source = layout_.sources[d.instance];
    const auto& targets = pose.morph_weights[source.node];
    for (std::uint32_t k = 0; k < d.morph_targets; ++k)
      if (store(weights[d.weight_first + k], static_cast<float>(k < targets.size() ? targets[k] : 0.0)))
        moved[d.instance] = true;
    if (d.joint_words == none) continue;
    const Skin& skin = scene_.skins[scene_.nodes[source.node].skin];
    Box box;
    for (std::size_t j = 0; j < skin.joints.size(); ++j) {
      const glm::dmat4 m = translation(-origin_) * pose.world[skin.joints[j]] * skin.inverse_bind[j] *
                           translation(scene_.meshes[source.mesh].centre);
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 4; ++c)
          if (store(matrices[(d.first_matrix + j) * 12 + r * 4 + c], static_cast<float>(m[c][r])))
            moved[d.instance] = true;
      merge(box, transformed(layout_.mesh_boxes[source.mesh], m));
    }
    boxes_[d.instance] = box;
  }
}

void DeviceScene::place_lights(const Pose& pose, const CameraView& camera) {
  const auto lights = lights_.view<gpu::Light>();
  light_positions_.clear();
  std::size_t count = 0;
  auto direction_of = [](const glm::dmat4& m, const glm::dvec3& axis) {
    const glm::dvec3 d = glm::dmat3(m) * axis;
    const double size = glm::length(d);
    return size > 0 ? glm::vec3(d / size) : glm::vec3(0, 0, -1);
  };
  for (const auto index : scene_.order) {
    if (scene_.nodes[index].light == none) continue;
    const Light& light = scene_.lights[scene_.nodes[index].light];
    gpu::Light g{};
    g.position = glm::vec3(glm::dvec3(pose.world[index][3]) - origin_);
    g.kind = static_cast<std::uint32_t>(light.kind);
    g.direction = direction_of(pose.world[index], {0, 0, -1});
    g.range = light.range;
    g.radiance = light.color * light.intensity;
    const float inner = std::cos(light.inner_cone), outer = std::cos(light.outer_cone);
    g.spot_scale = 1.0F / std::max(0.001F, inner - outer);
    g.spot_offset = -outer * g.spot_scale;
    if (light.kind != LightKind::directional) light_positions_.push_back(g.position);
    lights[count++] = g;
  }
  if (count > 0) return;
  gpu::Light g{};  // SHADING.md, Defaults
  g.kind = gpu::LIGHT_DIRECTIONAL;
  g.direction = direction_of(camera.to_world, {0.4, -0.7, -1.0});
  g.range = std::numeric_limits<float>::infinity();
  g.radiance = glm::vec3(3);
  lights[0] = g;
}

void DeviceScene::choose_pad(const CameraView& camera) {
  float largest = 1e-30F;
  auto add = [&](const glm::vec3& p) {
    for (int c = 0; c < 3; ++c)
      if (std::isfinite(p[c])) largest = std::max(largest, std::abs(p[c]));
  };
  for (const auto& box : boxes_) {
    add(box.lo);
    add(box.hi);
  }
  for (const auto& p : light_positions_) add(p);
  add(glm::vec3(glm::dvec3(camera.to_world[3]) - origin_));
  // A power of two, so that it seldom changes; then every box is made anew.
  const float pad = std::exp2(std::ceil(std::log2(largest)) - 21.0F);
  if (pad != box_pad_) fresh_ = true;
  box_pad_ = pad;
}

void DeviceScene::build_top_level(Recorder& recorder, std::vector<std::vector<std::uint32_t>>& heights) {
  HierarchyOptions options;
  options.leaf_size = 1;
  std::vector<Box> boxes;
  boxes.reserve(layout_.parts.size());
  for (const auto& part : layout_.parts) {
    const InstanceSource& source = layout_.sources[part.instance];
    boxes.push_back(source.deforms ? boxes_[part.instance] : transformed(part.box, to_world_[part.instance]));
  }
  auto tree = build_object_hierarchy(boxes, options);
  for (auto& node : tree.nodes) order_slots(node);
  const auto words = top_staging_.view<std::uint32_t>();
  std::fill(words.begin(), words.end(), 0U);
  const std::size_t above = layout_.refit_by_height.size();
  for (std::size_t n = 0; n < tree.nodes.size(); ++n) {
    for (std::uint32_t c = 0; c < wide; ++c) {
      auto child = tree.nodes[n].child[c];
      if (is_leaf(child)) child = layout_.parts[tree.order[leaf_first(child)]].child;
      words[n * gpu::NODE_WORDS + gpu::NODE_CHILD + c] = child;
    }
    const std::size_t height = above + tree.height[n];
    if (heights.size() <= height) heights.resize(height + 1);
    heights[height].push_back(static_cast<std::uint32_t>(n));
  }
  hierarchy_levels_ = static_cast<std::uint32_t>(heights.size());
  recorder.copy(top_staging_, nodes_, tree.nodes.size() * gpu::NODE_WORDS * 4);
}

Motion DeviceScene::list_work(const std::vector<bool>& moved, Recorder& recorder) {
  Motion motion;
  const auto triangles = triangle_work_.view<glm::uvec2>();
  for (std::uint32_t i = 0; i < moved.size(); ++i) {
    if (!moved[i]) continue;
    ++motion.moved_instances;
    for (std::uint32_t t = 0; t < layout_.instances[i].triangle_count; t += gpu::GROUP)
      triangles[motion.triangle_blocks++] = {i, t};
  }
  if (motion.moved_instances == 0) return motion;
  const auto vertices = vertex_work_.view<glm::uvec2>();
  for (std::uint32_t d = 0; d < layout_.deforms.size(); ++d)
    if (moved[layout_.deforms[d].instance])
      for (std::uint32_t v = 0; v < layout_.deforms[d].vertex_count; v += gpu::GROUP)
        vertices[motion.vertex_blocks++] = {d, v};
  if (!hierarchy_) return motion;
  std::vector<std::vector<std::uint32_t>> heights(layout_.refit_by_height.size());
  for (std::size_t h = 0; h < layout_.refit_by_height.size(); ++h)
    for (const auto node : layout_.refit_by_height[h])
      if (moved[layout_.node_instance[node - layout_.top_nodes]]) heights[h].push_back(node);
  build_top_level(recorder, heights);
  const auto list = refit_work_.view<std::uint32_t>();
  std::uint32_t at = 0;
  for (const auto& nodes : heights) {
    if (nodes.empty()) continue;
    std::copy(nodes.begin(), nodes.end(), list.begin() + at);
    motion.refit.emplace_back(at, static_cast<std::uint32_t>(nodes.size()));
    at += static_cast<std::uint32_t>(nodes.size());
  }
  return motion;
}

void DeviceScene::choose_origin(const Pose& pose, const CameraView& camera) {
  // A point of a grid about as fine as the scene is large, next to the camera. A function of scene, camera
  // and frame only; it stays put while the camera moves about inside the scene.
  const glm::dvec3 eye(camera.to_world[3]);
  glm::dvec3 lo(std::numeric_limits<double>::max()), hi(-std::numeric_limits<double>::max());
  for (const auto& source : layout_.sources) {
    const glm::dvec3 p((pose.world[source.node] * source.within_node)[3]);
    lo = glm::min(lo, p);
    hi = glm::max(hi, p);
    const Box& box = layout_.mesh_boxes[source.mesh];
    const glm::dmat3 linear(pose.world[source.node] * source.within_node);
    const double reach = glm::length(glm::dvec3(glm::max(glm::abs(box.lo), glm::abs(box.hi)))) *
                         std::max({glm::length(linear[0]), glm::length(linear[1]), glm::length(linear[2])});
    lo = glm::min(lo, p - reach);
    hi = glm::max(hi, p + reach);
  }
  const double size = layout_.sources.empty() ? 1 : std::max(glm::length(hi - lo), 1e-30);
  grid_ = std::exp2(std::ceil(std::log2(size)));
  const glm::dvec3 origin = grid_ * glm::floor(eye / grid_ + 0.5);
  if (origin != origin_) fresh_ = true;
  origin_ = origin;
}

Motion DeviceScene::update(const Pose& pose, const CameraView& camera, Recorder& recorder) {
  choose_origin(pose, camera);
  std::vector<bool> moved(layout_.instances.size(), false);
  place_instances(pose, moved);
  place_skins(pose, moved);
  place_lights(pose, camera);
  choose_pad(camera);
  if (fresh_) moved.assign(moved.size(), true);
  fresh_ = false;
  if (layout_.instances.empty() && hierarchy_) {
    std::vector<std::vector<std::uint32_t>> heights;
    build_top_level(recorder, heights);
  }
  return list_work(moved, recorder);
}

}  // namespace sheaf
