// SPDX-License-Identifier: MIT
// Small scenes made in memory, for tests whose answer is known by hand.
#pragma once

#include <glm/gtc/matrix_transform.hpp>
#include <vector>

#include "scene/camera_path.hpp"
#include "scene/pose.hpp"
#include "scene/scene.hpp"

namespace sheaf::test {

class SceneBuilder {
 public:
  SceneBuilder() { scene.materials.emplace_back().name = "default"; }

  Scene scene;
  Pose pose;

  std::uint32_t material(const Material& m) {
    scene.materials.push_back(m);
    return static_cast<std::uint32_t>(scene.materials.size() - 1);
  }
  std::uint32_t unlit(const glm::vec3& color) {
    Material m;
    m.base_color = glm::vec4(color, 1);
    m.unlit = true;
    return material(m);
  }

  std::uint32_t node(const glm::dmat4& world = glm::dmat4(1)) {
    const auto index = static_cast<std::uint32_t>(scene.nodes.size());
    scene.nodes.emplace_back();
    scene.roots.push_back(index);
    scene.order.push_back(index);
    pose.world.push_back(world);
    pose.morph_weights.emplace_back();
    return index;
  }

  /// A node with one mesh of one material; flat normals where none are given.
  std::uint32_t mesh(Mesh mesh, std::uint32_t material_index, const glm::dmat4& world = glm::dmat4(1)) {
    if (mesh.normals.empty()) {
      mesh.normals.resize(mesh.positions.size());
      for (const glm::uvec3& t : mesh.triangles) {
        const glm::vec3 n =
            glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]);
        for (int c = 0; c < 3; ++c) mesh.normals[t[c]] = glm::length(n) > 0 ? glm::normalize(n) : glm::vec3(0, 0, 1);
      }
    }
    mesh.material = material_index;
    const std::uint32_t index = node(world);
    scene.nodes[index].first_mesh = static_cast<std::uint32_t>(scene.meshes.size());
    scene.nodes[index].mesh_count = 1;
    scene.meshes.push_back(std::move(mesh));
    return index;
  }

  /// A square of side 2 * half round `centre`; u × v is the front's normal. Texture coordinates run along u and −v.
  static Mesh quad(const glm::vec3& centre, const glm::vec3& u, const glm::vec3& v, float half) {
    Mesh m;
    const glm::vec3 a = u * half, b = v * half;
    m.positions = {centre - a - b, centre + a - b, centre + a + b, centre - a + b};
    m.uv0 = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    m.triangles = {{0, 1, 2}, {0, 2, 3}};
    return m;
  }
  /// Facing +z at height z.
  static Mesh floor(float z, float half) { return quad({0, 0, z}, {1, 0, 0}, {0, 1, 0}, half); }

  /// A closed box, normals outward.
  static Mesh box(const glm::vec3& lo, const glm::vec3& hi) {
    Mesh m;
    const glm::vec3 middle = (lo + hi) * 0.5f, half = (hi - lo) * 0.5f;
    for (int axis = 0; axis < 3; ++axis) {
      for (const float side : {-1.0f, 1.0f}) {
        glm::vec3 n(0), u(0), v(0);
        n[axis] = side;
        u[(axis + 1) % 3] = 1;
        v = glm::cross(n, u);
        const auto first = static_cast<std::uint32_t>(m.positions.size());
        for (const glm::vec2 c : {glm::vec2(-1, -1), glm::vec2(1, -1), glm::vec2(1, 1), glm::vec2(-1, 1)}) {
          m.positions.push_back(middle + half * (n + u * c.x + v * c.y));
        }
        m.triangles.emplace_back(first, first + 1, first + 2);
        m.triangles.emplace_back(first, first + 2, first + 3);
      }
    }
    return m;
  }

  void light(const Light& l, const glm::dmat4& world) {
    const std::uint32_t index = node(world);
    scene.nodes[index].light = static_cast<std::uint32_t>(scene.lights.size());
    scene.lights.push_back(l);
  }
  void point_light(const glm::dvec3& at, float intensity, const glm::vec3& color = glm::vec3(1)) {
    Light l;
    l.intensity = intensity;
    l.color = color;
    light(l, glm::translate(glm::dmat4(1), at));
  }
  /// Keeps the default light and its environment away.
  void darkness() { point_light({0, 0, 1e6}, 0); }
};

/// From `eye` along `way`, one small parallel beam: every pixel of a picture sees the same ray but for 1e-9 m.
inline CameraView beam(const glm::dvec3& eye, const glm::dvec3& way) {
  const glm::dvec3 back = -glm::normalize(way);
  const glm::dvec3 side =
      glm::normalize(glm::cross(std::abs(back.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0), back));
  CameraView view;
  view.to_world =
      glm::dmat4(glm::dvec4(side, 0), glm::dvec4(glm::cross(back, side), 0), glm::dvec4(back, 0), glm::dvec4(eye, 1));
  view.orthographic = true;
  view.half_height = 1e-9;
  return view;
}

}  // namespace sheaf::test
