// SPDX-License-Identifier: MIT
#include "reference/whitted.hpp"

#include <algorithm>
#include <cmath>

namespace sheaf::reference {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
enum Kind : std::uint32_t { primary, shadow, reflection, refraction };

double largest(const glm::dvec3& v) { return std::max(std::max(v.x, v.y), v.z); }

/// −log2 of what a metre of the volume lets through; infinite where that is nothing, at whatever distance.
glm::dvec3 stops_a_metre(const Material& m) {
  const double distance = m.attenuation_distance;
  if (!(distance < infinity && distance > 0)) return glm::dvec3(0);
  return -glm::log2(glm::clamp(glm::dvec3(m.attenuation_color), 0.0, 1.0)) / distance;
}

/// Snell about n, which faces d; false in total internal reflection.
bool bend(const glm::dvec3& d, const glm::dvec3& n, double eta, glm::dvec3& out) {
  const double c = -glm::dot(d, n), k = 1 - eta * eta * (1 - c * c);
  if (!(k > 0)) return false;
  out = glm::normalize(eta * d + (eta * c - std::sqrt(k)) * n);
  return true;
}

}  // namespace

void Media::push(std::uint32_t material) {
  if (count_ == entries_.size()) {
    std::copy(entries_.begin() + 1, entries_.end(), entries_.begin());
    --count_;
  }
  entries_[count_++] = material;
}

void Media::remove(std::uint32_t material) {
  for (std::uint32_t i = count_; i-- > 0;) {
    if (entries_[i] != material) continue;
    std::copy(entries_.begin() + i + 1, entries_.begin() + count_, entries_.begin() + i);
    --count_;
    return;
  }
}

double Whitted::ior(std::uint32_t material) const { return material == none ? 1 : surfaces_.material(material).ior; }

Radiance Whitted::trace(const Ray& camera, double width, double spread, ReferenceCounts& counts) const {
  Work work{{}, {}, counts};
  work.rays.push_back({camera, glm::dvec3(1), 1, 0, primary, {}, width, spread});
  while (!work.rays.empty()) {
    const Pending ray = work.rays.back();
    work.rays.pop_back();
    Tests tests;
    const Hit hit = tracer_.closest(
        ray.ray, [this](const Hit& h) { return surfaces_.exists(h); }, tests);
    ++counts.rays[ray.kind];
    counts.box_tests[ray.kind] += tests.boxes;
    counts.triangle_tests[ray.kind] += tests.triangles;
    if (hit.triangle == none) {
      if (!(ray.coverage > 0)) work.sum.color += ray.weight * environment_;
      continue;
    }
    ++counts.hits[ray.kind];
    if (ray.kind == primary) work.sum.first = hit;
    shade(ray, hit, work);
  }
  return work.sum;
}

void Whitted::shade(const Pending& ray, const Hit& hit, Work& work) const {
  Pending here = ray;
  here.width = ray.width + ray.spread * hit.t;
  const Surface s = surfaces_.at(hit, ray.ray.direction, here.width);
  here.weight *= absorbed(ray, s, hit.t);
  const glm::dvec3 weight = here.weight * s.alpha;
  work.sum.alpha += ray.coverage * s.alpha;
  if (s.alpha < 1) {
    Pending straight = here;
    straight.weight *= 1 - s.alpha;
    straight.coverage *= 1 - s.alpha;
    straight.kind = refraction;
    go_on(s, ray.ray.direction, straight, work);
  }
  if (s.unlit) {
    work.sum.color += weight * s.base;
    return;
  }
  work.sum.color += weight * s.emission;
  const glm::dvec3 v = -ray.ray.direction;
  const double nv = std::clamp(glm::dot(s.normal, v), 1e-4, 1.0);
  const double r0 = (s.ior - 1) / (s.ior + 1);
  const glm::dvec3 f0 = glm::mix(glm::dvec3(r0 * r0), s.base, s.metallic);
  const double mirror = std::pow(std::max(1 - s.roughness / 0.4, 0.0), 2);
  const glm::dvec3 ambient = s.base * ((1 - s.metallic) * (1 - s.transmission)) + (1 - mirror) * schlick(f0, nv);
  work.sum.color += weight * environment_ * ambient * s.occlusion;
  light(s, weight, f0, v, work);
  if (s.transmission > 0) {
    transmit(s, weight, mirror, nv, here, work);
  } else {
    reflect(s, weight * mirror * schlick(f0, nv), here, work);
  }
}

void Whitted::light(const Surface& s, const glm::dvec3& weight, const glm::dvec3& f0, const glm::dvec3& v,
                    Work& work) const {
  for (const WorldLight& light : lights_) {
    const Arriving in = arriving(light, s.point);
    if (!(glm::dot(s.normal, in.towards) > 0 && glm::dot(s.geometric, in.towards) > 0)) continue;
    const glm::dvec3 carried = weight * reflectance(s, f0, v, in.towards) * in.radiance;
    if (!(largest(carried) > 0)) continue;
    work.sum.color += glm::max(carried, 0.0) * visibility(s, light, in, work.counts);
  }
}

// Traced from the point, where rounding is smallest. A volume that the light enters at a crossing and does not leave
// before the point absorbs over the way from there; one it leaves gives that way back.
glm::dvec3 Whitted::visibility(const Surface& s, const WorldLight& light, const Arriving& in,
                               ReferenceCounts& counts) const {
  Ray ray{s.start(in.towards), in.towards, 0, infinity};
  if (light.kind != LightKind::directional) {
    const glm::dvec3 way = light.position - ray.origin;
    const double distance = glm::length(way);
    if (distance > 0) ray.direction = way / distance;
    ray.tmax = distance * (1 - 1e-9);  // a surface that the light lies on does not stop it
  }
  glm::dvec3 passed(1), stops(0);
  bool met = false;
  Tests tests;
  const auto visit = [&](const Hit& hit) {
    const std::uint32_t material = surfaces_.material_of(hit);
    const bool there = surfaces_.exists(hit);
    met = met || there;
    passed *= surfaces_.transmittance(hit, ray.direction);
    if (there && surfaces_.is_volume(material)) {
      const bool entered = glm::dot(surfaces_.front_normal(hit, -ray.direction), ray.direction) > 0;
      const glm::dvec3 absorption = stops_a_metre(surfaces_.material(material));
      for (int c = 0; c < 3; ++c) {
        if (absorption[c] < infinity) {
          stops[c] += absorption[c] * (entered ? hit.t : -hit.t);
        } else {
          passed[c] = 0;
        }
      }
    }
    return largest(passed) > 0;
  };
  tracer_.for_each_hit(ray, visit, tests);
  ++counts.rays[shadow];
  counts.hits[shadow] += met ? 1 : 0;
  counts.box_tests[shadow] += tests.boxes;
  counts.triangle_tests[shadow] += tests.triangles;
  return passed * glm::exp2(-glm::max(stops, 0.0));
}

glm::dvec3 Whitted::absorbed(const Pending& ray, const Surface& s, double t) const {
  std::uint32_t inside = ray.media.top();
  if (inside == none && s.volume && !s.front) inside = s.material;  // the camera was inside
  return inside == none || !(t > 0) ? glm::dvec3(1) : glm::exp2(-stops_a_metre(surfaces_.material(inside)) * t);
}

void Whitted::transmit(const Surface& s, const glm::dvec3& weight, double mirror, double nv, const Pending& parent,
                       Work& work) const {
  Pending through = parent;
  double n1 = 1, n2 = s.ior;
  if (s.volume && s.front) {
    n1 = ior(parent.media.top());
    through.media.push(s.material);
  } else if (s.volume) {
    through.media.remove(s.material);
    n1 = s.ior;
    n2 = ior(through.media.top());
  }
  const glm::dvec3 d = parent.ray.direction;
  // A shading normal that faces away from the ray has no Fresnel term: the true normal stands in.
  const glm::dvec3 n = glm::dot(s.normal, d) < 0 ? s.normal : s.geometric;
  const double f = fresnel(std::clamp(-glm::dot(n, d), 0.0, 1.0), n1, n2);
  const glm::dvec3 reflected = glm::mix(glm::dvec3(f), schlick(s.base, nv), s.metallic);
  reflect(s, weight * glm::mix(mirror, 1.0, s.transmission) * reflected, parent, work);
  if (!(f < 1)) return;
  glm::dvec3 way = d;
  if (s.volume) {
    const double eta = n1 / n2;
    if (!bend(d, n, eta, way)) return;
    if (glm::dot(way, s.geometric) >= 0 && !bend(d, s.geometric, eta, way)) return;
    through.spread = eta * parent.spread + (glm::dot(way, n) - eta * glm::dot(d, n)) * s.curvature * parent.width;
  }
  through.weight = weight * s.base * (s.transmission * (1 - s.metallic) * (1 - f));
  through.coverage = 0;
  through.kind = refraction;
  go_on(s, way, through, work);
}

void Whitted::reflect(const Surface& s, const glm::dvec3& weight, const Pending& parent, Work& work) const {
  Pending child = parent;
  child.weight = weight;
  child.coverage = 0;
  child.kind = reflection;
  child.spread += 2 * s.curvature * parent.width;
  glm::dvec3 way = glm::reflect(parent.ray.direction, s.normal);
  if (!(glm::dot(way, s.geometric) > 0)) way = glm::reflect(parent.ray.direction, s.geometric);
  go_on(s, glm::normalize(way), child, work);
}

/// Lets a child go if it is worth it; `child` still holds its parent's ray and generation.
void Whitted::go_on(const Surface& s, const glm::dvec3& direction, const Pending& child, Work& work) const {
  const double worth = std::max(largest(child.weight), child.coverage);
  if (child.generation >= settings_.depth || !(worth > 0) || worth < settings_.cutoff) return;
  Pending& ray = work.rays.emplace_back(child);
  ++ray.generation;
  const bool back = child.kind == reflection;  // off the surface to the ray's own side; else through it
  ray.ray = {s.start(back ? s.geometric : -s.geometric), direction, 0, infinity};
}

}  // namespace sheaf::reference
