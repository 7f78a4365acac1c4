// SPDX-License-Identifier: MIT
#include "bounds_shaders.hpp"

#include <cmath>

namespace sheaf::test::shader {
namespace {
namespace gl {

using namespace glm;
using uint = unsigned int;

#include "convert.inc"
#include "ray_node.inc"
#include "triangle.inc"

struct Surface {
  vec3 point, point_error;
  float reach;
  vec3 geometric;
  uint rank = 0;
};
// Of surfaces that lie alone: what ranks.glsl adds is not asked for.
constexpr bool RANKED = false;
constexpr float STEEPEST = 1024.0F;
float sum_of(vec3 v) { return abs(v.x) + abs(v.y) + abs(v.z); }
float step_across(float) { return 0.0F; }

#include "bundle_bound.inc"
#include "offset.inc"
#include "spheres.inc"

}  // namespace gl

gl::RayNode as_shader(const Node& n) { return gl::RayNode(n.centre, n.radius, n.axis, n.angle, n.tmax); }

}  // namespace

glm::uvec2 divided(unsigned n, unsigned d) { return gl::divided(n, d); }
unsigned lowest_bit(unsigned v) { return gl::lowest_bit(v); }

Node node_over(const Node* below, int count) {
  using namespace glm;
  using gl::PAD;
  vec3 lo(INFINITY), hi(-INFINITY), sum(0);
  Node node;
  for (int k = 0; k < count; ++k) {
    const Node& n = below[k];
    lo = min(lo, n.centre - n.radius);
    hi = max(hi, n.centre + n.radius);
    sum += n.axis;
    node.tmax = std::max(node.tmax, n.tmax);
  }
  node.centre = 0.5F * lo + 0.5F * hi;
  const float size = length(sum);
  node.axis = size > 1e-3F ? sum / size : vec3(0, 0, 1);
  float angle = size > 1e-3F ? 0.0F : 4.0F;
  for (int k = 0; k < count; ++k) {
    const Node& n = below[k];
    const float distance = length(n.centre - node.centre);
    node.radius =
        std::max(node.radius,
                 n.centre != node.centre || n.radius > 0.0F ? (distance + n.radius) * (1.0F + PAD) + gl::LEAST : 0.0F);
    angle = std::max(angle, gl::angle_between(node.axis, n.axis) + n.angle);
  }
  node.angle = angle * (1.0F + PAD) + PAD;
  return node;
}

// What the lanes of bundle_rays.glsl gather, in the order of eight of them.
Bundle bundle_over(const std::vector<Node>& rays, float widest) {
  using namespace glm;
  gl::Spread s(vec3(INFINITY), vec3(-INFINITY), vec3(2), vec3(-2), vec3(0), 0.0F);
  vec3 lanes[8] = {};
  for (std::size_t i = 0; i < rays.size(); ++i) {
    s.olo = min(s.olo, rays[i].centre);
    s.ohi = max(s.ohi, rays[i].centre);
    s.dlo = min(s.dlo, rays[i].axis);
    s.dhi = max(s.dhi, rays[i].axis);
    lanes[i % 8] += rays[i].axis;
    s.tmax = std::max(s.tmax, rays[i].tmax);
  }
  for (const int step : {1, 2, 4})
    for (int k = 0; k < 8; k += 2 * step) lanes[k] += lanes[k + step];
  s.sum = lanes[0];
  const gl::RayNode n = gl::bundle_bound(s);
  return {{n.centre, n.radius, n.axis, n.angle, n.tmax}, gl::is_incoherent(n, s, widest)};
}

bool meets_sphere(const Node& node, const glm::vec3& centre, float radius) {
  return gl::node_meets_sphere(as_shader(node), centre, radius);
}

float angle_between(const glm::vec3& a, const glm::vec3& b) { return gl::angle_between(a, b); }

glm::vec4 triangle_sphere(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  return gl::triangle_sphere(a, b, c);
}

float padded_radius(float radius, float box_pad) { return radius * (1.0F + gl::PAD) + 2.0F * box_pad; }

Range slab(const glm::vec3& origin, const glm::vec3& direction, const glm::vec3& lo, const glm::vec3& hi) {
  const glm::vec2 range = gl::slab(gl::make_shear(origin, direction), lo, hi);
  return {range.x, range.y};
}

TriangleHit intersect(const glm::vec3& origin, const glm::vec3& direction, const glm::vec3 (&corner)[3],
                      float box_pad) {
  const auto hit = gl::intersect_triangle(gl::make_shear(origin, direction), corner[0], corner[1], corner[2], box_pad,
                                          0.0F, INFINITY);
  return {hit.hit, hit.t, hit.barycentric};
}

// The point, its error and the reach as surface_at has them.
glm::vec3 offset_origin(const glm::vec3 (&corner)[3], const glm::vec3& weights, const glm::vec3& direction,
                        const glm::vec3& towards, float length_of_ray) {
  using namespace glm;
  const vec3 a = corner[0] * weights.x, b = corner[1] * weights.y, c = corner[2] * weights.z;
  gl::Surface s;
  s.point = a + b + c;
  s.point_error = 4.172329e-7F * (abs(a) + abs(b) + abs(c));
  const vec3 reach = max(max(abs(corner[0] - s.point), abs(corner[1] - s.point)), abs(corner[2] - s.point));
  s.reach = std::max(std::max(reach.x, reach.y), reach.z);
  const vec3 g = cross(corner[1] - corner[0], corner[2] - corner[0]);
  const float size = length(g);
  s.geometric = size > 0.0F && size < INFINITY ? g / size : -direction;
  return gl::offset_origin(s, towards, length_of_ray);
}

}  // namespace sheaf::test::shader
