// SPDX-License-Identifier: MIT
#include "reference/light.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sheaf::reference {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

WorldLight world_light(const Light& light, const glm::dmat4& world, const glm::dvec3& origin) {
  WorldLight result;
  result.kind = light.kind;
  result.position = glm::dvec3(world[3]) - origin;
  const glm::dvec3 axis = -glm::dvec3(world[2]);
  const double length = glm::length(axis);
  result.direction = length > 0 ? axis / length : glm::dvec3(0, 0, -1);
  result.strength = glm::dvec3(light.color) * static_cast<double>(light.intensity);
  result.range = light.kind == LightKind::directional ? infinity : light.range;
  const double outer = std::cos(static_cast<double>(light.outer_cone));
  result.spot_scale = 1 / std::max(0.001, std::cos(static_cast<double>(light.inner_cone)) - outer);
  result.spot_offset = -outer * result.spot_scale;
  return result;
}

}  // namespace

bool has_lights(const Scene& scene) {
  return std::any_of(scene.order.begin(), scene.order.end(),
                     [&](std::uint32_t n) { return scene.nodes[n].light != none; });
}

std::vector<WorldLight> world_lights(const Scene& scene, const Pose& pose, const CameraView& view,
                                     const glm::dvec3& origin) {
  std::vector<WorldLight> lights;
  for (const std::uint32_t n : scene.order) {
    const std::uint32_t light = scene.nodes[n].light;
    if (light != none) lights.push_back(world_light(scene.lights[light], pose.world[n], origin));
  }
  if (lights.empty()) {  // over the camera's left shoulder
    const glm::dvec3 way = glm::dmat3(view.to_world) * glm::normalize(glm::dvec3(0.4, -0.7, -1));
    lights.push_back({LightKind::directional, glm::dvec3(0), glm::normalize(way), glm::dvec3(3), infinity, 1, 0});
  }
  return lights;
}

Arriving arriving(const WorldLight& light, const glm::dvec3& point) {
  constexpr double most = 1e9;
  if (light.kind == LightKind::directional) {
    return {glm::min(light.strength, glm::dvec3(most)), -light.direction, infinity};
  }
  const glm::dvec3 away = light.position - point;
  const double distance = glm::length(away);
  const glm::dvec3 towards = distance > 0 ? away / distance : glm::dvec3(0);
  double fade = light.range < infinity ? std::clamp(1 - std::pow(distance / light.range, 4), 0.0, 1.0) : 1;
  if (light.kind == LightKind::spot) {
    const double cone = glm::dot(-towards, light.direction) * light.spot_scale + light.spot_offset;
    fade *= std::pow(std::clamp(cone, 0.0, 1.0), 2);
  }
  const glm::dvec3 radiance = light.strength * (fade / std::max(distance * distance, 1e-30));
  return {glm::min(radiance, glm::dvec3(most)), towards, distance};
}

Lobes lobes_of(const Surface& s, double nv) {
  Lobes lobes;
  lobes.r0 = std::pow((s.ior - 1) / (s.ior + 1), 2);
  lobes.f0 = glm::mix(glm::dvec3(lobes.r0), s.base, s.metallic);
  lobes.mirrored = schlick(lobes.f0, nv);
  lobes.dielectric = schlick(glm::dvec3(lobes.r0), nv).x;
  lobes.share = std::pow(std::max(1 - s.roughness / 0.4, 0.0), 2);
  lobes.rise = std::pow(1 - 0.6 * (std::pow(std::max(s.roughness, 0.1), 2) - 0.01), 3);
  return lobes;
}

glm::dvec3 ambient(const Surface& s, const Lobes& lobes) {
  return s.base * ((1 - s.metallic) * (1 - s.transmission) * (1 - lobes.dielectric)) +
         (1 - lobes.share) * lobes.mirrored;
}

glm::dvec3 reflectance(const Surface& s, const Lobes& lobes, const glm::dvec3& v, const glm::dvec3& towards) {
  const double nl = glm::dot(s.normal, towards), nv = std::clamp(glm::dot(s.normal, v), 1e-4, 1.0);
  const glm::dvec3 sum = v + towards;
  const double length = glm::length(sum);
  const glm::dvec3 h = length > 0 ? sum / length : s.normal;
  const double nh = std::clamp(glm::dot(s.normal, h), 0.0, 1.0);
  const glm::dvec3 f = schlick(lobes.f0, std::clamp(glm::dot(v, h), 0.0, 1.0));
  const double alpha = std::pow(std::max(s.roughness, 0.1), 2), a2 = alpha * alpha;
  const double distribution = a2 / (std::numbers::pi * std::pow(nh * nh * (a2 - 1) + 1, 2));
  const double visibility = 0.5 / (nl * std::sqrt(nv * nv * (1 - a2) + a2) + nv * std::sqrt(nl * nl * (1 - a2) + a2));
  const auto kept = [&](double x) { return 1 - lobes.rise * std::pow(std::clamp(1 - x, 0.0, 1.0), 5); };
  const double most = (1 - lobes.r0) * kept(nv) * kept(nl) / (1 - lobes.rise / 21);
  const glm::dvec3 left = glm::min(1.0 - f, glm::dvec3(most));
  const glm::dvec3 diffuse = left * s.base * ((1 - s.metallic) * (1 - s.transmission) / std::numbers::pi);
  return (diffuse + f * (distribution * visibility)) * nl;
}

}  // namespace sheaf::reference
