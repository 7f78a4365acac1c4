// SPDX-License-Identifier: MIT
#include "reference/tracer.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace sheaf::reference {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

double next_up(double x) { return std::nextafter(x, infinity); }

/// The triangle's box in floats, wide enough for what the triangle test may round: 1e-7 of the largest coordinate is
/// some 10^8 times its error, so that rays from far away are safe too.
Box padded_box(const ReferenceTriangle& t, double pad) {
  const glm::dvec3 lo = glm::min(glm::min(t.v[0], t.v[1]), t.v[2]) - pad;
  const glm::dvec3 hi = glm::max(glm::max(t.v[0], t.v[1]), t.v[2]) + pad;
  const float most = std::numeric_limits<float>::infinity();
  Box box;
  for (int a = 0; a < 3; ++a) {
    box.lo[a] = std::nextafter(static_cast<float>(lo[a]), -most);
    box.hi[a] = std::nextafter(static_cast<float>(hi[a]), most);
  }
  return box;
}

struct Slabs {
  glm::dvec3 origin, inverse;

  explicit Slabs(const Ray& ray) : origin(ray.origin) {
    for (int a = 0; a < 3; ++a) {
      const double d = ray.direction[a];
      inverse[a] = 1 / (std::abs(d) < 1e-300 ? std::copysign(1e-300, d) : d);  // finite: no 0 * inf
    }
  }
  /// Entry into the box, or infinity where the ray misses it. Each plane's t has a relative error of at most three
  /// roundings (Ize 2013), which the slack covers.
  [[nodiscard]] double entry(const Box& box, double tmin, double tmax) const {
    constexpr double slack = 1e-15;
    const glm::dvec3 a = (glm::dvec3(box.lo) - origin) * inverse, b = (glm::dvec3(box.hi) - origin) * inverse;
    const glm::dvec3 n = glm::min(a, b), f = glm::max(a, b);
    const double in = std::max(std::max(n.x, n.y), n.z), out = std::min(std::min(f.x, f.y), f.z);
    const double from = in - std::abs(in) * slack;
    return from <= out + std::abs(out) * slack && out >= tmin && from <= tmax ? from : infinity;
  }
};

/// Turns space so that the direction's largest part is z, and shears it so that the direction is the z axis itself;
/// z is t.
struct Shear {
  int x, y, z;
  double across_x, across_y, along;

  explicit Shear(const glm::dvec3& d) {
    const glm::dvec3 size = glm::abs(d);
    z = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    x = (z + 1) % 3;
    y = (z + 2) % 3;
    across_x = d[x] / d[z];
    across_y = d[y] / d[z];
    along = 1 / d[z];
  }
  [[nodiscard]] glm::dvec3 apply(const glm::dvec3& v) const {
    return {v[x] - across_x * v[z], v[y] - across_y * v[z], along * v[z]};
  }
};

/// a·b − c·d with its true sign: rounding keeps the order of the products, and equal ones differ by what it took off.
double difference(double a, double b, double c, double d) {
  const double p = a * b, q = c * d;
  return p != q ? p - q : std::fma(a, b, -p) - std::fma(c, d, -q);
}

struct Entered {
  std::uint32_t child;
  double entry;
};

}  // namespace

// Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013, in double. The vertices are sheared so
// that the ray becomes an axis, each by itself: triangles that share a vertex see the same point of the plane. Around
// the ray's place in that plane every edge function then has its true sign, so no ray gets through between triangles.
bool intersect(const Ray& ray, const ReferenceTriangle& triangle, Hit& hit) {
  const Shear shear(ray.direction);
  const glm::dvec3 a = shear.apply(triangle.v[0] - ray.origin);
  const glm::dvec3 b = shear.apply(triangle.v[1] - ray.origin);
  const glm::dvec3 c = shear.apply(triangle.v[2] - ray.origin);
  const double u = difference(c.x, b.y, c.y, b.x);
  const double v = difference(a.x, c.y, a.y, c.x);
  const double w = difference(b.x, a.y, b.y, a.x);
  if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return false;
  const double sum = u + v + w;
  if (sum == 0 || !std::isfinite(sum)) return false;
  hit.barycentric = glm::dvec3(u, v, w) / sum;
  hit.t = hit.order = glm::dot(hit.barycentric, glm::dvec3(a.z, b.z, c.z));
  return hit.t >= ray.tmin && hit.t <= ray.tmax;
}

Tracer::Tracer(std::span<const ReferenceTriangle> triangles, std::uint32_t threads) : triangles_(triangles) {
  double largest = 0;
  for (const ReferenceTriangle& t : triangles) {
    for (const glm::dvec3& v : t.v) {
      largest = std::max({largest, std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    }
  }
  std::vector<Box> boxes;
  boxes.reserve(triangles.size());
  for (const ReferenceTriangle& t : triangles) boxes.push_back(padded_box(t, largest * 1e-7));
  tree_ = build_object_hierarchy(boxes, {.threads = threads});
}

template <class Visit>
void Tracer::walk(const Ray& ray, Tests& tests, const Visit& visit) const {
  const Slabs slabs(ray);
  std::array<Entered, max_wide_levels*(wide - 1) + 1> stack;
  std::size_t size = 0;
  stack[size++] = {0, ray.tmin};
  double limit = ray.tmax;
  while (size > 0) {
    const Entered at = stack[--size];
    if (at.entry > limit) continue;
    if (is_leaf(at.child)) {
      for (std::uint32_t i = 0; i < leaf_count(at.child); ++i) {
        Hit hit;
        hit.triangle = tree_.order[leaf_first(at.child) + i];
        ++tests.triangles;
        if (!intersect(ray, triangles_[hit.triangle], hit) || hit.t > limit) continue;
        limit = std::min(limit, visit(hit));
      }
      continue;
    }
    const WideNode& node = tree_.nodes[at.child];
    const std::size_t first = size;
    for (std::size_t c = 0; c < wide && node.child[c] != empty_child; ++c) {
      ++tests.boxes;
      const double entry = slabs.entry(node.bounds[c], ray.tmin, limit);
      if (entry < infinity) stack[size++] = {node.child[c], entry};
    }
    std::sort(stack.begin() + static_cast<std::ptrdiff_t>(first), stack.begin() + static_cast<std::ptrdiff_t>(size),
              [](const Entered& a, const Entered& b) { return a.entry > b.entry; });
  }
}

// Only the least order and the next double above it can win, so one candidate for each is kept: the answer does not
// depend on the order in which hits are found.
Hit Tracer::closest(const Ray& ray, const Accepts& accepts, Tests& tests) const {
  Hit least, above;
  walk(ray, tests, [&](Hit hit) {
    if (!accepts(hit) || (least.triangle != none && hit.order > next_up(least.order)))
      return least.triangle == none ? infinity : next_up(least.order);
    if (least.triangle == none || hit.order < least.order) {
      above = least.triangle != none && least.order == next_up(hit.order) ? least : Hit{};
      least = hit;
    } else {
      Hit& slot = hit.order == least.order ? least : above;
      if (hit.triangle < slot.triangle) slot = hit;  // none is the largest number
    }
    return next_up(least.order);
  });
  return above.triangle < least.triangle ? above : least;
}

void Tracer::for_each_hit(const Ray& ray, const std::function<bool(const Hit&)>& visit, Tests& tests) const {
  walk(ray, tests, [&](const Hit& hit) { return visit(hit) ? infinity : -infinity; });
}

}  // namespace sheaf::reference
