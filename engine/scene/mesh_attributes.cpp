// SPDX-License-Identifier: MIT
#include "scene/mesh_attributes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "scene/texture_transform.hpp"

namespace sheaf {
namespace {

template <class T>
void reorder(std::vector<T>& values, const std::vector<std::uint32_t>& order) {
  if (values.empty()) return;
  std::vector<T> out(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) out[i] = values[order[i]];
  values = std::move(out);
}

// In double, since the product of two edges of a large or tiny mesh leaves float's range.
glm::vec3 face_normal(const Mesh& mesh, const glm::uvec3& t) {
  const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
  const glm::dvec3 n = glm::cross(b - a, c - a);
  const double length = glm::length(n);
  return length > 0 && std::isfinite(length) ? glm::vec3(n / length) : glm::vec3(0, 0, 1);
}

glm::dvec3 any_perpendicular(const glm::dvec3& n) {
  const glm::dvec3 axis = std::abs(n.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  return glm::normalize(glm::cross(n, axis));
}

double corner_angle(const glm::dvec3& at, const glm::dvec3& b, const glm::dvec3& c) {
  const glm::dvec3 u = b - at, v = c - at;
  const double lengths = glm::length(u) * glm::length(v);
  return lengths > 0 ? std::acos(std::clamp(glm::dot(u, v) / lengths, -1.0, 1.0)) : 0.0;
}

struct FaceTangent {
  glm::dvec3 direction{0};  // dP/du, unit; zero where the texture coordinates have no area
  bool mirrored = false;    // the image is seen mirrored from the face's front: w = -1
  glm::dvec2 edges{1, 0};   // the direction's weights of the face's edges e1 and e2, up to a positive factor
};

FaceTangent face_tangent(const Mesh& mesh, const std::vector<glm::vec2>& uv, const glm::uvec3& t) {
  const glm::dvec3 e1 = glm::dvec3(mesh.positions[t.y]) - glm::dvec3(mesh.positions[t.x]);
  const glm::dvec3 e2 = glm::dvec3(mesh.positions[t.z]) - glm::dvec3(mesh.positions[t.x]);
  const glm::dvec2 d1 = glm::dvec2(uv[t.y]) - glm::dvec2(uv[t.x]), d2 = glm::dvec2(uv[t.z]) - glm::dvec2(uv[t.x]);
  const double area = d1.x * d2.y - d2.x * d1.y;
  // The bitangent, cross(n, t) * w, is up in the image (glTF 2.0, 3.9.3), against v, which grows downwards. An image
  // that is seen upright from the face's front therefore has a negative area in (u, v), and w = +1.
  const glm::dvec2 edges = glm::dvec2(d2.y, -d1.y) * (area < 0 ? -1.0 : 1.0);
  const double largest = std::max(std::abs(edges.x), std::abs(edges.y));
  if (area == 0 || !(largest > 0) || !std::isfinite(largest)) return {};
  const glm::dvec3 along = e1 * edges.x + e2 * edges.y;
  const double length = glm::length(along);
  if (!(length > 0) || !std::isfinite(length)) return {glm::dvec3(0), area > 0, edges / largest};
  return {along / length, area > 0, edges / largest};
}

// Vertices that both kinds of charts use get a second copy for the mirrored one.
void split_mirrored(Mesh& mesh, const std::vector<FaceTangent>& faces) {
  const std::size_t count = mesh.positions.size();
  std::vector<std::uint8_t> uses(count, 0);
  const auto bit = [](const FaceTangent& face) -> std::uint8_t {
    return face.direction == glm::dvec3(0) ? 0 : face.mirrored ? 2 : 1;
  };
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (int c = 0; c < 3; ++c) uses[mesh.triangles[f][c]] |= bit(faces[f]);
  }
  std::vector<std::uint32_t> order(count), copy(count, none);
  std::iota(order.begin(), order.end(), 0u);
  for (std::uint32_t v = 0; v < count; ++v) {
    if (uses[v] != 3) continue;
    copy[v] = static_cast<std::uint32_t>(order.size());
    order.push_back(v);
  }
  if (order.size() == count) return;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (bit(faces[f]) != 2) continue;
    for (int c = 0; c < 3; ++c) {
      std::uint32_t& v = mesh.triangles[f][c];
      if (copy[v] != none) v = copy[v];
    }
  }
  reorder_vertices(mesh, order);
}

}  // namespace

void reorder_vertices(Mesh& mesh, const std::vector<std::uint32_t>& order) {
  reorder(mesh.positions, order);
  reorder(mesh.normals, order);
  reorder(mesh.tangents, order);
  reorder(mesh.uv0, order);
  reorder(mesh.uv1, order);
  reorder(mesh.colors, order);
  reorder(mesh.joints, order);
  reorder(mesh.weights, order);
  for (MorphTarget& target : mesh.targets) {
    reorder(target.positions, order);
    reorder(target.normals, order);
    reorder(target.tangents, order);
    reorder(target.uv0, order);
    reorder(target.uv1, order);
    reorder(target.colors, order);
  }
}

void make_flat_normals(Mesh& mesh) {
  mesh.flat = true;
  mesh.tangents.clear();
  mesh.normals.clear();
  for (MorphTarget& target : mesh.targets) {
    target.normals.clear();
    target.tangents.clear();
  }
  std::vector<std::uint32_t> order;
  order.reserve(mesh.triangles.size() * 3);
  for (const glm::uvec3& t : mesh.triangles) order.insert(order.end(), {t.x, t.y, t.z});
  reorder_vertices(mesh, order);
  mesh.normals.resize(order.size());
  for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f) {
    mesh.triangles[f] = glm::uvec3(3 * f, 3 * f + 1, 3 * f + 2);
    const glm::vec3 n = face_normal(mesh, mesh.triangles[f]);
    for (std::uint32_t c = 0; c < 3; ++c) mesh.normals[3 * f + c] = n;
  }
}

void normalize_normals(Mesh& mesh) {
  std::vector<bool> lost(mesh.normals.size(), false);
  bool any = false;
  for (std::size_t v = 0; v < mesh.normals.size(); ++v) {
    const glm::dvec3 n(mesh.normals[v]);
    const double length = glm::length(n);
    if (length > 0) {
      mesh.normals[v] = glm::vec3(n / length);
    } else {
      lost[v] = any = true;
      mesh.normals[v] = glm::vec3(0, 0, 1);
    }
  }
  if (!any) return;
  for (const glm::uvec3& t : mesh.triangles) {
    for (int c = 0; c < 3; ++c) {
      if (!lost[t[c]]) continue;
      mesh.normals[t[c]] = face_normal(mesh, t);
      lost[t[c]] = false;
    }
  }
}

void make_tangents(Mesh& mesh, const TextureUse& use) {
  const std::vector<glm::vec2>& source = use.uv_set == 0 ? mesh.uv0 : mesh.uv1;
  std::vector<FaceTangent> faces(mesh.triangles.size());
  if (!source.empty()) {
    std::vector<glm::vec2> uv(source.size());
    std::ranges::transform(source, uv.begin(), [&](const glm::vec2& at) { return transformed_uv(use, at); });
    for (std::size_t f = 0; f < faces.size(); ++f) faces[f] = face_tangent(mesh, uv, mesh.triangles[f]);
    split_mirrored(mesh, faces);
  }
  if (mesh.flat)
    for (const FaceTangent& face : faces) mesh.face_tangents.emplace_back(face.edges);

  std::vector<glm::dvec3> sums(mesh.positions.size(), glm::dvec3(0));
  std::vector<float> handedness(mesh.positions.size(), 1.0f);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (faces[f].direction == glm::dvec3(0)) continue;
    const glm::uvec3 t = mesh.triangles[f];
    const std::array<glm::dvec3, 3> p = {mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]};
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t v = t[static_cast<int>(c)];
      sums[v] += faces[f].direction * corner_angle(p[c], p[(c + 1) % 3], p[(c + 2) % 3]);
      handedness[v] = faces[f].mirrored ? -1.0f : 1.0f;
    }
  }
  mesh.tangents.resize(mesh.positions.size());
  for (std::size_t v = 0; v < sums.size(); ++v) {
    const glm::dvec3 n(mesh.normals[v]);
    const glm::dvec3 flat = sums[v] - n * glm::dot(n, sums[v]);
    const double length = glm::length(flat);
    // Below 1e-6 the direction is rounding noise: u runs along the normal, or its faces cancel out.
    const glm::dvec3 t = length > 1e-6 ? flat / length : any_perpendicular(n);
    mesh.tangents[v] = glm::vec4(glm::vec3(t), handedness[v]);
  }
}

}  // namespace sheaf
