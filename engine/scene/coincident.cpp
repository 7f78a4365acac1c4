// SPDX-License-Identifier: MIT
#include "scene/coincident.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <tuple>

#include "scene/rest_surfaces.hpp"
#include "scene/surface_order.hpp"

namespace sheaf {
namespace {

constexpr std::uint64_t most_triangles = 4'000'000;
constexpr std::uint64_t most_looks = 20'000'000;  // at pairs of triangles: a second at most
constexpr double tolerance = 0x1p-20;             // of the distance from the scene's middle: nearer planes are one
constexpr double turn_cell = 0x1p-6, turn_slack = 0x1p-11;     // of a unit normal's coordinates
constexpr double depth_cell = 0x1p-12, depth_slack = 0x1p-18;  // of the scene's size

using Triangle = std::array<glm::dvec3, 3>;

struct Entry {  // a triangle in a cell of planes
  std::uint64_t cell;
  std::uint32_t surface, triangle;
};

struct Flat {  // a triangle, seen along an axis
  std::array<glm::dvec2, 3> at;
  glm::dvec2 lo, hi;
  Triangle corner;
  glm::dvec3 normal;  // unit
  double reach;       // largest coordinate, from the scene's middle
  std::uint32_t surface;
};

std::uint64_t mixed(std::uint64_t key, std::int64_t word) {
  key = (key ^ static_cast<std::uint64_t>(word)) * 0x9E3779B97F4A7C15U;
  return key ^ (key >> 29U);
}

class Search {
 public:
  Search(const Scene& scene, const SurfaceView& view) : scene_(scene), view_(view), surfaces_(rest_surfaces(scene)) {
    glm::dvec3 lo(std::numeric_limits<double>::max()), hi(-std::numeric_limits<double>::max());
    for (const RestSurface& s : surfaces_) {
      lo = glm::min(lo, s.lo);
      hi = glm::max(hi, s.hi);
    }
    middle_ = 0.5 * (lo + hi);
    size_ = std::max({hi.x - lo.x, hi.y - lo.y, hi.z - lo.z, 1e-300});
  }

  Coincidence run() {
    Coincidence result;
    if (surfaces_.size() < 2 || !std::isfinite(size_)) return result;
    list_planes();
    std::sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) {
      return std::tie(a.cell, a.surface, a.triangle) < std::tie(b.cell, b.surface, b.triangle);
    });
    for (std::size_t first = 0, end = 0; first < entries_.size(); first = end) {
      while (end < entries_.size() && entries_[end].cell == entries_[first].cell) ++end;
      if (entries_[first].surface != entries_[end - 1].surface) search_cell(first, end);
    }
    if (!neighbours_.empty()) give_ranks(result);
    return result;
  }

 private:
  [[nodiscard]] Triangle corners(std::uint32_t surface, std::uint32_t triangle) const {
    const RestSurface& s = surfaces_[surface];
    const glm::uvec3 v = s.mesh->triangles[triangle];
    return {s.position(v.x), s.position(v.y), s.position(v.z)};
  }

  // Planes near a cell's border go into the cell beyond as well.
  void list_planes() {
    for (std::uint32_t s = 0; s < surfaces_.size(); ++s) {
      if (!surfaces_[s].may_meet) continue;
      for (std::uint32_t t = 0; t < surfaces_[s].mesh->triangles.size(); ++t) {
        const Triangle c = corners(s, t);
        glm::dvec3 n = glm::cross(c[1] - c[0], c[2] - c[0]);
        const double length = glm::length(n);
        if (!(length > 0) || !std::isfinite(length)) continue;
        n /= length;
        const int first = std::abs(n.x) > 2 * turn_slack ? 0 : std::abs(n.y) > 2 * turn_slack ? 1 : 2;
        if (n[first] < 0) n = -n;
        const double depth = glm::dot(n, c[0] - middle_) / size_;
        const std::array<std::array<double, 3>, 4> words{{{n.x, turn_cell, turn_slack},
                                                          {n.y, turn_cell, turn_slack},
                                                          {n.z, turn_cell, turn_slack},
                                                          {depth, depth_cell, depth_slack}}};
        std::array<std::uint64_t, 16> keys{0};
        std::size_t count = 1;
        for (const auto& [value, cell, slack] : words) {
          const auto low = static_cast<std::int64_t>(std::floor((value - slack) / cell + 0.5));
          const auto high = static_cast<std::int64_t>(std::floor((value + slack) / cell + 0.5));
          const std::size_t so_far = count;
          for (std::size_t k = 0; k < so_far; ++k) {
            if (high != low) keys[count++] = mixed(keys[k], high);
            keys[k] = mixed(keys[k], low);
          }
        }
        for (std::size_t k = 0; k < count; ++k) entries_.push_back({keys[k], s, t});
      }
    }
  }

  [[nodiscard]] Flat flat(const Entry& e, int axis) const {
    Flat f;
    f.corner = corners(e.surface, e.triangle);
    f.surface = e.surface;
    f.lo = glm::dvec2(std::numeric_limits<double>::max());
    f.hi = -f.lo;
    f.reach = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      f.at[k] = {f.corner[k][(axis + 1) % 3], f.corner[k][(axis + 2) % 3]};
      f.lo = glm::min(f.lo, f.at[k]);
      f.hi = glm::max(f.hi, f.at[k]);
      const glm::dvec3 off = glm::abs(f.corner[k] - middle_);
      f.reach = std::max({f.reach, off.x, off.y, off.z});
    }
    f.normal = glm::normalize(glm::cross(f.corner[1] - f.corner[0], f.corner[2] - f.corner[0]));
    return f;
  }

  void search_cell(std::size_t first, std::size_t end) {
    const Triangle one = corners(entries_[first].surface, entries_[first].triangle);
    const glm::dvec3 n = glm::abs(glm::cross(one[1] - one[0], one[2] - one[0]));
    const int axis = n.x >= n.y && n.x >= n.z ? 0 : n.y >= n.z ? 1 : 2;
    std::vector<Flat> flats;
    for (std::size_t e = first; e < end; ++e) flats.push_back(flat(entries_[e], axis));
    std::sort(flats.begin(), flats.end(), [](const Flat& a, const Flat& b) { return a.lo.x < b.lo.x; });
    for (std::size_t i = 0; i < flats.size(); ++i)
      for (std::size_t k = i + 1; k < flats.size() && flats[k].lo.x < flats[i].hi.x; ++k) {
        if (++looks_ > most_looks) return;
        if (flats[i].surface != flats[k].surface && flats[k].lo.y < flats[i].hi.y && flats[i].lo.y < flats[k].hi.y)
          compare(flats[i], flats[k]);
      }
  }

  void compare(const Flat& a, const Flat& b) {
    const std::pair<std::uint32_t, std::uint32_t> pair = std::minmax(a.surface, b.surface);
    if (neighbours_.count(pair) != 0 || never_together(a, b)) return;
    const double near = tolerance * std::max(a.reach, b.reach);
    if (in_plane(a, b, near) || in_plane(b, a, near))
      if (overlap(a, b, near)) neighbours_.insert(pair);
  }

  // Back to back and single-sided: no ray sees both.
  [[nodiscard]] bool never_together(const Flat& a, const Flat& b) const {
    if (view_.opaque || view_.show_backs) return false;
    const RestSurface &s = surfaces_[a.surface], &t = surfaces_[b.surface];
    const Material &m = scene_.materials[s.mesh->material], &n = scene_.materials[t.mesh->material];
    if (m.double_sided || m.transmission > 0 || n.double_sided || n.transmission > 0) return false;
    return glm::dot(a.normal, b.normal) * s.side * t.side < 0;
  }

  static bool in_plane(const Flat& plane, const Flat& other, double near) {
    return std::all_of(other.corner.begin(), other.corner.end(), [&](const glm::dvec3& p) {
      return std::abs(glm::dot(plane.normal, p - plane.corner[0])) <= near;
    });
  }

  // False where some edge has the other triangle on its far side: then they touch at most.
  static bool overlap(const Flat& a, const Flat& b, double near) { return !parted(a, b, near) && !parted(b, a, near); }
  static bool parted(const Flat& a, const Flat& b, double near) {
    const auto cross = [](const glm::dvec2& u, const glm::dvec2& v) { return u.x * v.y - u.y * v.x; };
    const double turn = cross(a.at[1] - a.at[0], a.at[2] - a.at[0]) < 0 ? -1 : 1;
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec2 edge = a.at[(k + 1) % 3] - a.at[k];
      const double size = glm::length(edge);
      if (std::all_of(b.at.begin(), b.at.end(),
                      [&](const glm::dvec2& p) { return turn * cross(edge, p - a.at[k]) <= near * size; }))
        return true;
    }
    return false;
  }

  // Volumes from the last rank down; then the others, each kind behind the kinds before it, and not with its own in one
  // rank.
  void give_ranks(Coincidence& result) {
    std::map<std::uint32_t, std::set<std::uint32_t>> beside;
    for (const auto& [a, b] : neighbours_) {
      beside[a].insert(b);
      beside[b].insert(a);
    }
    std::vector<std::pair<std::vector<double>, std::uint32_t>> order;
    for (const auto& [s, others] : beside) {
      const RestSurface& at = surfaces_[s];
      order.emplace_back(content_of(scene_, scene_.materials[at.mesh->material], *at.mesh, at.world, view_), s);
    }
    std::sort(order.begin(), order.end());
    const auto kind = [&](std::uint32_t s) { return kind_of(scene_.materials[surfaces_[s].mesh->material], view_); };
    std::map<std::uint32_t, std::uint32_t> ranks;
    const auto rank_all = [&](bool volumes) {
      for (const auto& [content, s] : order)
        if ((kind(s) == SurfaceKind::volume) == volumes) {
          std::set<std::uint32_t> taken;
          std::uint32_t lo = 1, hi = last_rank;
          for (const auto other : beside[s]) {
            const auto found = ranks.find(other);
            if (found == ranks.end()) continue;
            if (kind(other) == kind(s)) {
              taken.insert(found->second);
            } else if (kind(other) == SurfaceKind::volume) {
              lo = std::max(lo, last_rank + 2 - found->second);
              hi = std::min(hi, found->second - 1);
            } else {
              lo = std::max(lo, found->second + 1);
            }
          }
          std::uint32_t rank = volumes ? last_rank : std::min(lo, hi);
          while (taken.count(rank) != 0 && (volumes ? rank > last_rank - 2 : rank < hi)) volumes ? --rank : ++rank;
          ranks[s] = rank;
        }
    };
    rank_all(true);
    rank_all(false);
    result.by_node.resize(scene_.nodes.size());
    for (const auto& [s, rank] : ranks) {
      const RestSurface& at = surfaces_[s];
      const Node& node = scene_.nodes[at.node];
      auto& of_node = result.by_node[at.node];
      of_node.resize(node.mesh_count * std::max<std::size_t>(node.instances.size(), 1));
      of_node[at.copy * node.mesh_count + at.mesh_index - node.first_mesh] = {rank, kind(s) == SurfaceKind::volume};
      result.extent = std::max({result.extent, at.hi.x - at.lo.x, at.hi.y - at.lo.y, at.hi.z - at.lo.z});
    }
  }

  const Scene& scene_;
  SurfaceView view_;
  std::vector<RestSurface> surfaces_;
  glm::dvec3 middle_{0};
  double size_ = 1;
  std::vector<Entry> entries_;
  std::set<std::pair<std::uint32_t, std::uint32_t>> neighbours_;
  std::uint64_t looks_ = 0;
};

}  // namespace

SurfaceRank Coincidence::of(const Scene& scene, std::uint32_t node, std::uint32_t mesh, std::size_t copy) const {
  if (node >= by_node.size() || by_node[node].empty()) return {};
  return by_node[node][copy * scene.nodes[node].mesh_count + mesh - scene.nodes[node].first_mesh];
}

Coincidence find_coincident(const Scene& scene, const SurfaceView& view) {
  if (view.opaque) return {};  // what an outside checker can follow: the nearest hit
  std::uint64_t triangles = 0;
  for (const std::uint32_t index : scene.order) {
    const Node& node = scene.nodes[index];
    for (std::uint32_t m = node.first_mesh; m < node.first_mesh + node.mesh_count; ++m)
      triangles += scene.meshes[m].triangles.size() * std::max<std::size_t>(node.instances.size(), 1);
  }
  return triangles > most_triangles ? Coincidence{} : Search(scene, view).run();
}

}  // namespace sheaf
