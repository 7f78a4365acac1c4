// SPDX-License-Identifier: MIT
// Nodes over rays (R 4.3, H): a sphere that holds all origins, a cone that holds all directions.
//
// The cone keeps its half-angle, not a cosine: near 0 a float cosine cannot tell 0 from 3e-4 rad.
// Padding. angle_between errs by less than 4·2^-24 + 6·2^-24·angle (two products and a difference a coordinate of the
// cross product, the square root, 4 ulps of `arc`); unit axes are off unit by 2^-23. PAD = 2^-20 absolute and relative
// covers the sum of both and of the addition. Distances: three squares, a root and a subtraction, 4·2^-24 relative;
// again PAD. The centre is any point: only the distances from it must be bounded.
#ifndef SHEAF_RAY_NODE_GLSL
#define SHEAF_RAY_NODE_GLSL
struct RayNode {
  vec3 centre;
  float radius;
  vec3 axis;
  float angle;  // half-angle; ≥ π/2: no cone, every direction
  float tmax;
};

const float PAD = 9.5367432e-7;
const float LEAST = 1.3010426e-18;  // 2^-59; a length of three squares that vanish is 2^-63·√3 at most
const float HALF_PI = 1.57079632679;

// Angle of (x, y) from the x axis, y ≥ 0. Not the built-in atan: Vulkan lets it err by 4096 ulps, and llvmpipe's errs
// by 4e-6 of the angle (its asin by 4e-4). Here t ≤ tan(π/8), where the polynomial (a minimax fit of (atan(t)/t − 1)/t²
// in t²) is right to 2e-8 of the angle; the rest is the rounding of a quotient, two products and two sums.
float arc(float y, float x) {
  float across = abs(x), t = min(across, y) / max(across, y);
  bool upper = t > 0.41421356;
  if (upper) t = (t - 1.0) / (t + 1.0);
  float z = t * t;
  float angle = t + t * z * (((0.0806031 * z - 0.1387985) * z + 0.19977926) * z - 0.33332955);
  if (upper) angle += 0.5 * HALF_PI;
  if (y > across) angle = HALF_PI - angle;
  return x < 0.0 ? 2.0 * HALF_PI - angle : angle;
}

float angle_between(vec3 a, vec3 b) { return arc(length(cross(a, b)), dot(a, b)); }

RayNode load_ray_node_words(float w0, float w1, float w2, float w3, float w4, float w5, float w6, float w7, float w8) {
  return RayNode(vec3(w0, w1, w2), w3, vec3(w4, w5, w6), w7, w8);
}

#define LOAD_RAY_NODE(buffer, at)                                                                              \
  load_ray_node_words(buffer[at], buffer[at + 1u], buffer[at + 2u], buffer[at + 3u], buffer[at + 4u], buffer[at + 5u], \
                      buffer[at + 6u], buffer[at + 7u], buffer[at + 8u])

// A node as the test against many spheres wants it.
struct Cone {
  RayNode node;
  float cosine, sine;
};

// Sine and cosine of an angle from 0 to π/2. Not the built-in ones: Vulkan lets them err by 2^-11. The series end where
// what they leave out is 6e-8 and 7e-9; Horner's sums add 2^-23.
float sine_of(float x) {
  float z = x * x;
  return x + x * z * (-1.6666667e-1 + z * (8.3333333e-3 + z * (-1.9841270e-4 + z * (2.7557319e-6 - z * 2.5052108e-8))));
}
float cosine_of(float x) {
  float z = x * x;
  return 1.0 - z * (0.5 - z * (4.1666667e-2 -
                               z * (1.3888889e-3 - z * (2.4801587e-5 - z * (2.7557319e-7 - z * 2.0876757e-9)))));
}

// Past π/2 there is no cone, and neither value is asked for.
Cone cone_of(RayNode n) { return Cone(n, cosine_of(min(n.angle, HALF_PI)), sine_of(min(n.angle, HALF_PI))); }

// Whether some ray of the node may meet the sphere (algorithm 6). w = |v × a|, not a root of a difference, which
// cancels. The comparisons give way by SLACK of the lengths involved: three products and two sums a side, and sin, cos
// to 2^-21; and by LEAST, since squares of what is shorter than 2^-63 are not normal floats.
bool cone_meets_sphere(Cone cone, vec3 centre, float radius) {
  RayNode n = cone.node;
  const float SLACK = 3.8146973e-6;  // 2^-18
  vec3 v = centre - n.centre;
  float distance = length(v);
  float reach = radius + n.radius;
  float give = SLACK * (distance + reach) + LEAST;
  reach += give;
  if (distance <= reach) return true;
  if (distance - reach > n.tmax) return false;
  if (!(n.angle < HALF_PI)) return true;
  float z = dot(v, n.axis), w = length(cross(v, n.axis));
  float c = cone.cosine, s = cone.sine;
  if (z * c + w * s < -give) return false;      // the apex is the nearest point, and it is outside
  return !(w * c - z * s > reach);
}

bool node_meets_sphere(RayNode n, vec3 centre, float radius) { return cone_meets_sphere(cone_of(n), centre, radius); }
#endif
