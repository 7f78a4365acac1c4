// SPDX-License-Identifier: MIT
// Camera paths evaluated. Positions under catmull-rom follow the non-uniform Catmull-Rom spline over the key times;
// rotations follow the cumulative Bézier curve of Kim, Kim and Shin ("A General Construction Scheme for Unit Quaternion
// Curves with Simple High Order Derivatives", 1995) with angular velocities chosen as Catmull-Rom chooses velocities,
// so that both pass through every key with a continuous derivative. Lenses change linearly.
#include "scene/camera_path.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "scene/rigid.hpp"

namespace sheaf {
namespace {

// Half the rotation vector of a unit quaternion, and back.
glm::dvec3 log_of(glm::dquat q) {
  if (q.w < 0) q = -q;  // the shorter way round
  const glm::dvec3 v(q.x, q.y, q.z);
  const double sine = glm::length(v);
  return sine > 0 ? v * (std::atan2(sine, q.w) / sine) : glm::dvec3(0);
}

glm::dquat exp_of(const glm::dvec3& half) {
  const double angle = glm::length(half);
  const double scale = angle > 1e-12 ? std::sin(angle) / angle : 1.0;
  return unit_or_identity({std::cos(angle), half.x * scale, half.y * scale, half.z * scale});
}

glm::dvec3 turn(const CameraKey& a, const CameraKey& b) { return log_of(glm::conjugate(a.rotation) * b.rotation); }

struct Velocity {
  glm::dvec3 linear{0}, angular{0};  // a second; angular as half a rotation vector in the key's own frame
};

Velocity chord(const CameraKey& a, const CameraKey& b) {
  const double span = b.time - a.time;
  return {(b.position - a.position) / span, turn(a, b) / span};
}

bool closes(const CameraPath& path) {
  const CameraKey &a = path.keys.front(), &b = path.keys.back();
  const double size = 1 + glm::length(a.position);
  return path.loop && path.keys.size() > 2 && glm::distance(a.position, b.position) < 1e-9 * size &&
         glm::length(turn(a, b)) < 1e-9;
}

// The velocity of the parabola through a key and its neighbours; of the chord where it has one alone. A closed loop has
// neighbours across the seam.
Velocity velocity_at(const CameraPath& path, std::size_t i) {
  const std::vector<CameraKey>& k = path.keys;
  const std::size_t last = k.size() - 1;
  const bool seam = (i == 0 || i == last) && closes(path);
  if (i == 0 && !seam) return chord(k[0], k[1]);
  if (i == last && !seam) return chord(k[last - 1], k[last]);
  const CameraKey &a0 = seam ? k[last - 1] : k[i - 1], &a1 = seam ? k[last] : k[i];
  const CameraKey &b0 = seam ? k[0] : k[i], &b1 = seam ? k[1] : k[i + 1];
  const double before = a1.time - a0.time, after = b1.time - b0.time;
  const Velocity v0 = chord(a0, a1), v1 = chord(b0, b1);
  const double w0 = after / (before + after), w1 = before / (before + after);
  return {v0.linear * w0 + v1.linear * w1, v0.angular * w0 + v1.angular * w1};
}

void place_smoothly(const CameraPath& path, std::size_t i, double t, CameraKey& out) {
  const CameraKey &a = path.keys[i], &b = path.keys[i + 1];
  const double span = b.time - a.time, t2 = t * t, t3 = t2 * t;
  const Velocity va = velocity_at(path, i), vb = velocity_at(path, i + 1);
  out.position = a.position * (2 * t3 - 3 * t2 + 1) + va.linear * (span * (t3 - 2 * t2 + t)) +
                 b.position * (-2 * t3 + 3 * t2) + vb.linear * (span * (t3 - t2));

  const glm::dvec3 first = va.angular * (span / 3), third = vb.angular * (span / 3);
  const glm::dvec3 second = log_of(exp_of(-first) * glm::conjugate(a.rotation) * b.rotation * exp_of(-third));
  const double s = 1 - t;
  out.rotation = unit_or_identity(a.rotation * exp_of(first * (1 - s * s * s)) * exp_of(second * (3 * t2 - 2 * t3)) *
                                  exp_of(third * t3));
}

void place_linearly(const CameraKey& a, const CameraKey& b, double t, CameraKey& out) {
  out.position = a.position + (b.position - a.position) * t;
  out.rotation = unit_or_identity(a.rotation * exp_of(turn(a, b) * t));
}

void blend_lens(const CameraKey& a, const CameraKey& b, double t, CameraKey& out) {
  if (a.orthographic != b.orthographic) return;  // there is nothing between the two: the earlier one holds
  const auto mix = [&](double from, double to) {
    return std::isfinite(from) && std::isfinite(to) ? from + (to - from) * t : from;
  };
  out.fov = mix(a.fov, b.fov);
  out.ortho_height = mix(a.ortho_height, b.ortho_height);
  out.near = mix(a.near, b.near);
  out.far = mix(a.far, b.far);
}

CameraKey key_at(const CameraPath& path, double time) {
  const std::vector<CameraKey>& keys = path.keys;
  const double start = keys.front().time, range = keys.back().time - start;
  if (path.loop && range > 0) time -= std::floor((time - start) / range) * range;
  if (!(time > start)) return keys.front();
  if (time >= keys.back().time) return keys.back();
  const auto after = std::ranges::upper_bound(keys, time, {}, &CameraKey::time);
  const auto i = static_cast<std::size_t>(after - keys.begin()) - 1;
  CameraKey out = keys[i];
  if (path.interpolation == PathInterpolation::step) return out;
  const double t = (time - keys[i].time) / (keys[i + 1].time - keys[i].time);
  if (path.interpolation == PathInterpolation::linear) {
    place_linearly(keys[i], keys[i + 1], t, out);
  } else {
    place_smoothly(path, i, t, out);
  }
  blend_lens(keys[i], keys[i + 1], t, out);
  return out;
}

// Whether what is between two keys can be computed: a position is a sum of four terms, each no longer than these.
bool is_sound(const CameraPath& path, std::size_t i) {
  constexpr double room = std::numeric_limits<double>::max() / 16;
  const auto fits = [](const glm::dvec3& v) { return glm::all(glm::lessThan(glm::abs(v), glm::dvec3(room))); };
  const CameraKey &a = path.keys[i], &b = path.keys[i + 1];
  const double span = b.time - a.time;
  if (!std::isfinite(span)) return false;
  if (path.interpolation == PathInterpolation::step) return true;
  if (!fits(a.position) || !fits(b.position)) return false;
  if (path.interpolation == PathInterpolation::linear) return true;
  const Velocity va = velocity_at(path, i), vb = velocity_at(path, i + 1);
  return fits(va.linear * span) && fits(vb.linear * span) && fits(va.angular * span) && fits(vb.angular * span);
}

}  // namespace

std::optional<std::size_t> first_unsound_key(const CameraPath& path) {
  if (!std::isfinite(path.keys.back().time - path.keys.front().time)) return 0;
  for (std::size_t i = 0; i + 1 < path.keys.size(); ++i)
    if (!is_sound(path, i)) return i;
  return std::nullopt;
}

CameraView evaluate_camera_path(const CameraPath& path, double time_s, double aspect) {
  const CameraKey key = key_at(path, time_s);
  CameraView view;
  view.to_world = glm::mat4_cast(key.rotation);
  view.to_world[3] = glm::dvec4(key.position, 1);
  view.orthographic = key.orthographic;
  view.tan_half_y = std::tan(key.fov / 2) / (path.fov_horizontal ? aspect : 1.0);
  view.half_height = key.ortho_height / 2;
  view.near = key.near;
  view.far = key.far;
  return view;
}

}  // namespace sheaf
