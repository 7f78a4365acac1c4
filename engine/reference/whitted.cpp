// SPDX-License-Identifier: MIT
#include "reference/whitted.hpp"

#include <algorithm>
#include <cmath>

namespace sheaf::reference {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr std::uint32_t most_blended = 64;
enum Kind : std::uint32_t { primary, shadow, reflection, refraction };

double largest(const glm::dvec3& v) { return std::max(std::max(v.x, v.y), v.z); }
double mean(const glm::dvec3& v) { return (v.x + v.y + v.z) / 3; }

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
  work.rays.push_back({camera, glm::dvec3(1), 1, 0, 0, primary, {}, width, spread});
  while (!work.rays.empty()) {
    const Pending ray = work.rays.back();
    work.rays.pop_back();
    Tests tests;
    const Hit hit = tracer_.closest(
        ray.ray, [&](Hit& h) { return surfaces_.seen(h, ray.ray); }, tests);
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
  const glm::dvec3 left = absorbed(ray, s, hit.t);
  here.weight *= left;
  if (settings_.transparent_glass) {  // what is absorbed hides what is behind
    work.sum.alpha += here.coverage * (1 - mean(left));
    here.coverage *= mean(left);
  }
  const glm::dvec3 weight = here.weight * s.alpha;
  work.sum.alpha += here.coverage * s.alpha;
  if (s.alpha < 1) {
    Pending straight = here;
    straight.weight *= 1 - s.alpha;
    straight.coverage *= 1 - s.alpha;
    straight.kind = refraction;
    go_straight(s, straight, work);
  }
  if (s.unlit) {
    work.sum.color += weight * s.base;
    return;
  }
  work.sum.color += weight * s.emission;
  const glm::dvec3 v = -ray.ray.direction;
  const double nv = std::clamp(glm::dot(s.normal, v), 1e-4, 1.0);
  Lobes lobes = lobes_of(s, nv);
  if (s.transmission > 0) {
    const Interface face = see_through(s, nv, here, lobes);
    work.sum.alpha -= transmit(s, weight, lobes, face, here, work);
  }
  work.sum.color += weight * environment_ * ambient(s, lobes) * s.occlusion;
  light(s, weight, lobes, v, work);
  reflect(s, weight * lobes.share * lobes.mirrored, here, work);
}

void Whitted::light(const Surface& s, const glm::dvec3& weight, const Lobes& lobes, const glm::dvec3& v,
                    Work& work) const {
  for (const WorldLight& light : lights_) {
    const Arriving in = arriving(light, s.point);
    const bool faces = glm::dot(s.geometric, in.towards) > 0 || s.is_lifted_to(in.towards);
    if (!(glm::dot(s.normal, in.towards) > 0 && faces)) continue;
    const glm::dvec3 carried = weight * reflectance(s, lobes, v, in.towards) * in.radiance;
    if (!(largest(carried) > 0)) continue;
    work.sum.color += glm::max(carried, 0.0) * visibility(s, light, in, work.counts);
  }
}

// Traced from the point, where rounding is smallest. A volume that the light enters at a crossing and does not leave
// before the point absorbs over the way from there; one it leaves gives that way back.
glm::dvec3 Whitted::visibility(const Surface& s, const WorldLight& light, const Arriving& in,
                               ReferenceCounts& counts) const {
  Ray ray{s.is_lifted_to(in.towards) ? s.lifted_start() : s.start(in.towards), in.towards, 0, infinity};
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

/// Step 7: the lobes of a surface that lets light through.
Whitted::Interface Whitted::see_through(const Surface& s, double nv, const Pending& parent, Lobes& lobes) const {
  Interface face{s.normal, 1, s.ior, parent.media};
  if (s.volume && s.front) {
    face.n1 = ior(parent.media.top());
    face.beyond.push(s.material);
  } else if (s.volume) {
    face.beyond.remove(s.material);
    face.n1 = s.ior;
    face.n2 = ior(face.beyond.top());
  }
  const glm::dvec3 d = parent.ray.direction;
  // A shading normal that faces away from the ray has no Fresnel term: the true normal stands in.
  if (!(glm::dot(s.normal, d) < 0)) face.normal = s.geometric;
  lobes.dielectric = fresnel(std::clamp(-glm::dot(face.normal, d), 0.0, 1.0), face.n1, face.n2);
  lobes.mirrored = glm::mix(glm::dvec3(lobes.dielectric), schlick(s.base, nv), s.metallic);
  lobes.share = glm::mix(lobes.share, 1.0, s.transmission);
  return face;
}

/// Step 9. What the ray takes along of its parent's coverage.
double Whitted::transmit(const Surface& s, const glm::dvec3& weight, const Lobes& lobes, const Interface& face,
                         const Pending& parent, Work& work) const {
  if (!(lobes.dielectric < 1)) return 0;
  Pending through = parent;
  const glm::dvec3 d = parent.ray.direction;
  glm::dvec3 way = d;
  if (s.volume) {
    const double eta = face.n1 / face.n2;
    if (!bend(d, face.normal, eta, way)) return 0;
    if (glm::dot(way, s.geometric) >= 0 && !bend(d, s.geometric, eta, way)) return 0;
    through.spread = eta * parent.spread +
                     (glm::dot(way, face.normal) - eta * glm::dot(d, face.normal)) * s.curvature * parent.width;
  }
  const glm::dvec3 share = s.base * (s.transmission * (1 - s.metallic) * (1 - lobes.dielectric));
  through.media = face.beyond;
  through.weight = weight * share;
  through.coverage = settings_.transparent_glass ? parent.coverage * std::min(mean(share), 1.0) : 0;
  through.kind = refraction;
  return go_on(s, way, through, work) ? through.coverage : 0;
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

/// Lets a child go if it is worth it, and says so; `child` still holds its parent's ray and bounces.
bool Whitted::go_on(const Surface& s, const glm::dvec3& direction, const Pending& child, Work& work) const {
  if (child.bounces >= settings_.depth || !worth_a_ray(child)) return false;
  Pending& ray = work.rays.emplace_back(child);
  ++ray.bounces;
  ray.ray = s.go_on(direction, child.kind == reflection);  // off the surface to the ray's own side; else through it
  return true;
}

/// Through a blended surface, which is no bounce but has a bound of its own.
void Whitted::go_straight(const Surface& s, const Pending& child, Work& work) const {
  if (!worth_a_ray(child)) return;
  if (child.blended >= most_blended) {
    ++work.counts.stopped;
    return;
  }
  Pending& ray = work.rays.emplace_back(child);
  ++ray.blended;
  ray.ray = s.go_on(child.ray.direction, false);
}

bool Whitted::worth_a_ray(const Pending& ray) const {
  const double worth = std::max(largest(ray.weight), ray.coverage);
  return worth > 0 && worth >= settings_.cutoff;
}

}  // namespace sheaf::reference
