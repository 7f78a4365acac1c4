// SPDX-License-Identifier: MIT
// Functions of the shaders, compiled for the CPU (tests/subjects/bounds.cmake): every operation in single precision.
#pragma once

#include <glm/glm.hpp>
#include <vector>

namespace sheaf::test::shader {

struct Node {
  glm::vec3 centre{0};
  float radius = 0;
  glm::vec3 axis{0};
  float angle = 0, tmax = 0;
};

struct TriangleHit {
  bool hit;
  float t;
  glm::vec3 barycentric;
};

struct Range {
  float entry, leave;
};

/// Quotient and remainder, and the lowest bit set (convert.glsl).
glm::uvec2 divided(unsigned n, unsigned d);
unsigned lowest_bit(unsigned v);

/// One node over a few rays or nodes, as rays_hierarchy.comp makes it.
Node node_over(const Node* below, int count);
/// The node over a bundle, and whether it is too wide (`widest`: half-angle) to be walked as one.
struct Bundle {
  Node node;
  bool incoherent;
};
Bundle bundle_over(const std::vector<Node>& rays, float widest);
bool meets_sphere(const Node& node, const glm::vec3& centre, float radius);
float angle_between(const glm::vec3& a, const glm::vec3& b);

/// Centre and radius, without and with objects_spheres.comp's padding.
glm::vec4 triangle_sphere(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c);
float padded_radius(float radius, float box_pad);

Range slab(const glm::vec3& origin, const glm::vec3& direction, const glm::vec3& lo, const glm::vec3& hi);
TriangleHit intersect(const glm::vec3& origin, const glm::vec3& direction, const glm::vec3 (&corner)[3], float box_pad);

/// A ray's new origin where one along `direction` met a triangle (weights of its corners), on the side of `towards`.
glm::vec3 offset_origin(const glm::vec3 (&corner)[3], const glm::vec3& weights, const glm::vec3& direction,
                        const glm::vec3& towards, float length_of_ray);

}  // namespace sheaf::test::shader
