// SPDX-License-Identifier: MIT
#include "scene/pose.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "core/error.hpp"
#include "core/quote.hpp"
#include "scene/rigid.hpp"

namespace sheaf {
namespace {

struct Trs {
  glm::dvec3 translation{0};
  glm::dquat rotation{1, 0, 0, 0};
  glm::dvec3 scale{1};
};

Trs rest_parts(const Node& node) {
  if (!node.has_matrix) return {node.translation, node.rotation, node.scale};
  Trs parts;
  parts.translation = glm::dvec3(node.matrix[3]);
  glm::dmat3 basis(node.matrix);
  for (int c = 0; c < 3; ++c) parts.scale[c] = glm::length(basis[c]);
  if (glm::determinant(basis) < 0) parts.scale.x = -parts.scale.x;
  parts.rotation = glm::quat_cast(orthonormal_basis(basis));
  return parts;
}

// Where a time falls among a channel's keys: between `key` and `key + 1`, at `fraction` of the way.
struct Place {
  std::size_t key = 0;
  double fraction = 0, span = 0;
};

Place find_place(const std::vector<double>& times, double time) {
  if (!(time > times.front())) return {};  // also where time is NaN
  if (time >= times.back()) return {times.size() - 1, 0, 0};
  const auto after = std::upper_bound(times.begin(), times.end(), time);
  const auto key = static_cast<std::size_t>(after - times.begin()) - 1;
  const double span = times[key + 1] - times[key];
  return {key, (time - times[key]) / span, span};
}

// Shortest-arc slerp of unit quaternions. Close to each other their arc's sine loses its digits: lerp is exact enough.
glm::dquat slerp_shortest(const glm::dquat& a, glm::dquat b, double t) {
  double cosine = glm::dot(a, b);
  if (cosine < 0) b = -b, cosine = -cosine;
  if (cosine > 1 - 1e-9) return unit_or_identity(a * (1 - t) + b * t);
  const double angle = std::acos(std::min(cosine, 1.0));
  return unit_or_identity((a * std::sin((1 - t) * angle) + b * std::sin(t * angle)) / std::sin(angle));
}

glm::dquat quaternion_at(const double* v) { return {v[3], v[0], v[1], v[2]}; }

// glTF 2.0, appendix C.5; keys hold in-tangent, value, out-tangent.
void cubic_spline(const Channel& channel, const Place& place, std::vector<double>& out) {
  const std::size_t width = channel.width;
  const double* k0 = channel.values.data() + place.key * 3 * width;
  if (place.span == 0) {
    out.assign(k0 + width, k0 + 2 * width);
    return;
  }
  const double* k1 = k0 + 3 * width;
  const double t = place.fraction, t2 = t * t, t3 = t2 * t;
  for (std::size_t c = 0; c < width; ++c) {
    out[c] = (2 * t3 - 3 * t2 + 1) * k0[width + c] + place.span * (t3 - 2 * t2 + t) * k0[2 * width + c] +
             (-2 * t3 + 3 * t2) * k1[width + c] + place.span * (t3 - t2) * k1[c];
  }
}

void sample(const Channel& channel, double time, std::vector<double>& out) {
  const std::size_t width = channel.width;
  const Place place = find_place(channel.times, time);
  out.resize(width);
  if (channel.interpolation == Interpolation::cubic_spline) return cubic_spline(channel, place, out);
  const double* a = channel.values.data() + place.key * width;
  if (channel.interpolation == Interpolation::step || place.span == 0) {
    out.assign(a, a + width);
    return;
  }
  const double* b = a + width;
  if (channel.path == ChannelPath::rotation) {
    const glm::dquat q =
        slerp_shortest(unit_or_identity(quaternion_at(a)), unit_or_identity(quaternion_at(b)), place.fraction);
    out = {q.x, q.y, q.z, q.w};
    return;
  }
  for (std::size_t c = 0; c < width; ++c) out[c] = a[c] + (b[c] - a[c]) * place.fraction;
}

glm::dmat4 matrix_of(const Trs& parts) {
  glm::dmat4 m = glm::mat4_cast(parts.rotation);
  for (int c = 0; c < 3; ++c) m[c] *= parts.scale[c];
  m[3] = glm::dvec4(parts.translation, 1);
  return m;
}

// Calls visit(channel) for every channel of the chosen animations, in their order.
template <class Visit>
void each_channel(const Scene& scene, const std::vector<std::uint32_t>& animations, const Visit& visit) {
  for (const std::uint32_t index : animations) {
    for (const Channel& channel : scene.animations.at(index).channels) visit(channel);
  }
}

// Calls visit(node), parents before children.
template <class Visit>
void each_posed(const Scene& scene, const Visit& visit) {
  for (const std::uint32_t i : scene.order) visit(i);
  for (const std::uint32_t i : scene.outside) visit(i);
}

std::vector<std::uint32_t> chosen_animations(const Scene& scene, const std::string& selector) {
  const auto count = static_cast<std::uint32_t>(scene.animations.size());
  if (selector.empty()) return count == 0 ? std::vector<std::uint32_t>{} : std::vector<std::uint32_t>{0};
  for (std::uint32_t i = 0; i < count; ++i) {
    if (scene.animations[i].name == selector) return {i};
  }
  if (selector == "all") {
    std::vector<std::uint32_t> all(count);
    for (std::uint32_t i = 0; i < count; ++i) all[i] = i;
    return all;
  }
  const bool digits =
      selector.size() <= 9 && std::ranges::all_of(selector, [](char c) { return c >= '0' && c <= '9'; });
  if (digits && std::stoul(selector) < count) return {static_cast<std::uint32_t>(std::stoul(selector))};
  std::vector<std::string> names;
  for (const Animation& animation : scene.animations) names.push_back(animation.name);
  throw input_error(scene.path, "there is no animation " + in_quotes(selector) + ", it has " +
                                    (count == 0 ? "none" : quoted_list(names)));
}

}  // namespace

std::vector<std::uint32_t> select_animations(const Scene& scene, const std::string& selector) {
  std::vector<std::uint32_t> chosen = chosen_animations(scene, selector);
  for (const std::uint32_t index : chosen) {
    const std::string& fault = scene.animations[index].fault;
    if (!fault.empty()) throw Error(ErrorKind::input, fault);
  }
  return chosen;
}

Pose evaluate_pose(const Scene& scene, const std::vector<std::uint32_t>& animations, double time_s) {
  std::vector<Trs> parts(scene.nodes.size());
  std::vector<bool> from_parts(scene.nodes.size());
  Pose pose;
  pose.morph_weights.resize(scene.nodes.size());
  for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
    from_parts[i] = !scene.nodes[i].has_matrix;
    if (from_parts[i]) parts[i] = rest_parts(scene.nodes[i]);
    pose.morph_weights[i] = scene.nodes[i].morph_weights;
  }

  std::vector<double> v;
  each_channel(scene, animations, [&](const Channel& channel) {
    sample(channel, time_s, v);
    if (channel.path == ChannelPath::weights) {
      if (pose.morph_weights[channel.node].size() == v.size()) pose.morph_weights[channel.node] = v;
      return;
    }
    Trs& node = parts[channel.node];
    if (!from_parts[channel.node]) node = rest_parts(scene.nodes[channel.node]);
    from_parts[channel.node] = true;
    if (channel.path == ChannelPath::rotation) {
      node.rotation = unit_or_identity(quaternion_at(v.data()));
    } else {
      (channel.path == ChannelPath::translation ? node.translation : node.scale) = glm::dvec3(v[0], v[1], v[2]);
    }
  });

  pose.world.assign(scene.nodes.size(), glm::dmat4(1));
  each_posed(scene, [&](std::uint32_t i) {
    const Node& node = scene.nodes[i];
    const glm::dmat4 local = from_parts[i] ? matrix_of(parts[i]) : node.matrix;
    pose.world[i] = node.parent == none ? local : pose.world[node.parent] * local;
  });
  return pose;
}

std::vector<bool> moving_nodes(const Scene& scene, const std::vector<std::uint32_t>& animations) {
  std::vector<bool> moving(scene.nodes.size(), false);
  each_channel(scene, animations, [&](const Channel& channel) {
    if (channel.path != ChannelPath::weights) moving[channel.node] = true;
  });
  each_posed(scene, [&](std::uint32_t i) {
    const std::uint32_t parent = scene.nodes[i].parent;
    if (parent != none && moving[parent]) moving[i] = true;
  });
  return moving;
}

bool may_mirror(const Scene& scene, const Skin& skin) {
  std::vector<bool> animated(scene.nodes.size(), false);
  for (const Animation& animation : scene.animations) {
    for (const Channel& channel : animation.channels) {
      if (channel.path != ChannelPath::scale) continue;
      // A spline between positive keys may swing below 0.
      if (channel.interpolation == Interpolation::cubic_spline ||
          std::ranges::any_of(channel.values, [](double v) { return v < 0; }))
        animated[channel.node] = true;
    }
  }
  const auto mirrors = [&](std::uint32_t node) {
    const Node& n = scene.nodes[node];
    return animated[node] ||
           (n.has_matrix ? glm::determinant(glm::dmat3(n.matrix)) : n.scale.x * n.scale.y * n.scale.z) < 0;
  };
  for (std::size_t j = 0; j < skin.joints.size(); ++j) {
    if (glm::determinant(glm::dmat3(skin.inverse_bind[j])) < 0) return true;
    for (std::uint32_t node = skin.joints[j]; node != none; node = scene.nodes[node].parent)
      if (mirrors(node)) return true;
  }
  return false;
}

std::vector<bool> morphing_nodes(const Scene& scene, const std::vector<std::uint32_t>& animations) {
  std::vector<bool> morphing(scene.nodes.size(), false);
  each_channel(scene, animations, [&](const Channel& channel) {
    if (channel.path == ChannelPath::weights) morphing[channel.node] = true;
  });
  return morphing;
}

}  // namespace sheaf
