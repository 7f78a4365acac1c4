// SPDX-License-Identifier: MIT
// Nothing leaks: rays aimed at the edges and vertices of closed meshes, from inside and outside, by every strategy. A
// ray from inside a closed mesh, or one that goes on to pass well within it, must hit; how often it does not is the
// number of leaks: 0.
#include <map>

#include "device_world.hpp"

namespace sheaf::test {
namespace {

using Rays = std::vector<TestRay>;

Mesh icosphere(int times) {
  Mesh mesh;
  const float g = 1.618034F;
  mesh.positions = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                    {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (; times > 0; --times) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [place, is_new] =
          middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(mesh.positions.size()));
      if (is_new) mesh.positions.push_back((mesh.positions[a] + mesh.positions[b]) * 0.5F);
      return place->second;
    };
    std::vector<glm::uvec3> finer;
    for (const auto& t : mesh.triangles) {
      const auto ab = middle(t.x, t.y), bc = middle(t.y, t.z), ca = middle(t.z, t.x);
      finer.insert(finer.end(), {{t.x, ab, ca}, {t.y, bc, ab}, {t.z, ca, bc}, {ab, bc, ca}});
    }
    mesh.triangles = finer;
  }
  for (auto& p : mesh.positions) p = glm::normalize(p);
  return mesh;
}

/// The cube [-half, half]³ cut into unit squares: vertices, edges and many rays through them are exact in floats.
Mesh grid_cube(int half) {
  Mesh mesh;
  std::map<std::array<int, 3>, std::uint32_t> vertices;
  auto vertex = [&](const glm::ivec3& p) {
    const auto [place, is_new] =
        vertices.try_emplace({p.x, p.y, p.z}, static_cast<std::uint32_t>(mesh.positions.size()));
    if (is_new) mesh.positions.emplace_back(p);
    return place->second;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {-half, half})
      for (int u = -half; u < half; ++u)
        for (int v = -half; v < half; ++v) {
          auto corner = [&](int du, int dv) {
            glm::ivec3 p(0);
            p[axis] = side;
            p[(axis + 1) % 3] = u + du;
            p[(axis + 2) % 3] = v + dv;
            return vertex(p);
          };
          const auto a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
          mesh.triangles.emplace_back(a, b, c);
          mesh.triangles.emplace_back(a, c, d);
        }
  return mesh;
}

void move(Mesh& mesh, float scale, const glm::vec3& shift) {
  for (auto& p : mesh.positions) p = p * scale + shift;
}

/// A vertex, or a point of an edge: its middle, anywhere on it, or a hair from its end.
glm::dvec3 seam(Dice& dice, const Mesh& mesh) {
  const auto& t = mesh.triangles[dice.below(static_cast<std::uint32_t>(mesh.triangles.size()))];
  const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]);
  switch (dice.below(4)) {
    case 0:
      return a;
    case 1:
      return (a + b) * 0.5;
    case 2:
      return glm::mix(a, b, dice.magnitude(1e-7, 1e-2));
    default:
      return glm::mix(a, b, dice.unit());
  }
}

/// From a point within half the size to a seam, or from beyond the seam through it to that point.
Rays seam_rays(const Mesh& mesh, double size, const glm::dvec3& centre, std::size_t count, std::uint32_t seed) {
  Dice dice(seed);
  Rays rays(count);
  for (auto& ray : rays) {
    const glm::dvec3 within = dice.below(8) == 0 ? centre : centre + dice.cube() * (0.4 * size), at = seam(dice, mesh);
    const bool from_inside = dice.below(2) != 0;
    ray.origin = glm::vec3(from_inside ? within : at + (at - within) * dice.magnitude(0.01, 10));
    ray.direction = glm::vec3(glm::normalize(at - glm::dvec3(ray.origin)));
  }
  return rays;
}

std::size_t leaks(DeviceWorld& world, std::uint32_t kind, const Rays& rays) {
  const auto hits = world.trace(kind, rays);
  return static_cast<std::size_t>(std::count(hits.begin(), hits.end(), ~0ULL));
}

DeviceWorld world_of(const Mesh& mesh, Strategy strategy, std::size_t rays) {
  SceneBuilder builder;
  builder.mesh(mesh, 0);
  return {builder, {strategy, SortPolicy::on, static_cast<std::uint32_t>(rays)}};
}

struct Place {
  float scale;
  glm::vec3 shift;
};

TEST(DeviceWatertight, NoRayLeaksThroughASphere) {
  constexpr std::size_t count = 100000;
  const Place places[] = {{1, {0, 0, 0}}, {1, {1000, -2000, 500}}, {1e-6F, {0, 0, 0}}, {1e6F, {0, 0, 0}}};
  for (std::uint32_t k = 0; k < std::size(places); ++k) {
    Mesh mesh = icosphere(3);
    move(mesh, places[k].scale, places[k].shift);
    const Rays rays = seam_rays(mesh, places[k].scale * 0.9, glm::dvec3(places[k].shift), count, k);
    DeviceWorld world = world_of(mesh, Strategy::bvh, count);
    EXPECT_EQ(leaks(world, gpu::KIND_REFLECTION, rays), 0U) << "of " << count << ", place " << k;
    EXPECT_EQ(leaks(world, gpu::KIND_SHADOW, rays), 0U) << "of " << count << ", place " << k;
  }
}

TEST(DeviceWatertight, NoStrategyLeaks) {
  constexpr std::size_t count = 20000;
  const Mesh mesh = icosphere(2);
  const Rays rays = seam_rays(mesh, 0.9, {0, 0, 0}, count, 77);
  for (const auto strategy :
       {Strategy::brute, Strategy::hybrid, Strategy::rsh, Strategy::crsh, Strategy::frustum, Strategy::classify}) {
    DeviceWorld world = world_of(mesh, strategy, count);
    EXPECT_EQ(leaks(world, gpu::KIND_REFLECTION, rays), 0U) << name_of(strategy);
    EXPECT_EQ(leaks(world, gpu::KIND_SHADOW, rays), 0U) << name_of(strategy);
  }
}

// Along the axes through vertices, along edges' lines, in the planes of faces' neighbours: edge functions of exactly 0.
TEST(DeviceWatertight, ExactRaysThroughVerticesAndEdgesHit) {
  constexpr int half = 8;
  const Mesh mesh = grid_cube(half);
  Rays rays;
  for (int u = -half + 1; u < half; ++u)
    for (int v = -half + 1; v < half; ++v)
      for (int axis = 0; axis < 3; ++axis)
        for (const float way : {-1.0F, 1.0F})
          for (const float fraction : {0.0F, 0.5F})
            for (const float from : {0.0F, -3.0F, -20.0F}) {
              TestRay ray;
              ray.origin[(axis + 1) % 3] = static_cast<float>(u) + fraction;
              ray.origin[(axis + 2) % 3] = static_cast<float>(v);
              ray.origin[axis] = from * way;
              ray.direction = glm::vec3(0);
              ray.direction[axis] = way;
              rays.push_back(ray);
            }
  for (int axis = 0; axis < 3; ++axis)  // from the centre, in the plane of a row of edges
    for (int u = -half; u <= half; ++u)
      for (const float way : {-1.0F, 1.0F}) {
        TestRay ray;
        ray.direction = glm::vec3(0);
        ray.direction[axis] = way * half;
        ray.direction[(axis + 1) % 3] = static_cast<float>(u);
        ray.direction = glm::normalize(ray.direction);
        rays.push_back(ray);
      }
  for (const auto strategy : {Strategy::brute, Strategy::bvh, Strategy::hybrid, Strategy::rsh}) {
    DeviceWorld world = world_of(mesh, strategy, rays.size());
    EXPECT_EQ(leaks(world, gpu::KIND_REFLECTION, rays), 0U) << name_of(strategy);
    EXPECT_EQ(leaks(world, gpu::KIND_SHADOW, rays), 0U) << name_of(strategy);
  }
}

}  // namespace
}  // namespace sheaf::test
