// SPDX-License-Identifier: MIT
// The one definition of "this ray hits this triangle", the same bits in every strategy.
//
// Watertight: Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013. The edge functions of two
// triangles that share an edge are exact negatives of each other (no contraction: `precise`), so no ray slips between
// them; a zero is settled by the exact sign of the two products (Dekker's splitting).
//
// Box-consistent: a hit also passes the slab test of the triangle's own padded box, and t is clamped to that interval.
// Subtraction and multiplication by a constant are monotone under rounding, so the interval of any box that holds the
// triangle's (padded by the same box_pad) contains this one bit for bit. Hence a traversal that skips boxes whose entry
// lies beyond the best t can never skip a nearer or equal hit: all strategies give the same bytes, with no tolerance.
#ifndef SHEAF_TRIANGLE_GLSL
#define SHEAF_TRIANGLE_GLSL

struct Shear {  // what a ray contributes to every test
  vec3 origin;
  vec3 inverse;  // 1/direction, components kept finite
  float sx, sy, sz;
  uint axis;     // dominant axis of the direction
};

vec3 permute(vec3 v, uint axis) { return axis == 0u ? v.yzx : axis == 1u ? v.zxy : v; }

Shear make_shear(vec3 origin, vec3 direction) {
  vec3 a = abs(direction);
  uint axis = a.x >= a.y && a.x >= a.z ? 0u : a.y >= a.z ? 1u : 2u;
  vec3 d = permute(direction, axis);
  Shear s;
  s.origin = origin;
  s.axis = axis;
  precise float sz = 1.0 / d.z;
  precise float sx = d.x / d.z;
  precise float sy = d.y / d.z;
  s.sx = sx;
  s.sy = sy;
  s.sz = sz;
  // A direction component below 1e-18 moves a ray by less than a picometre over a megametre: box_pad covers it, and the
  // finite reciprocal keeps 0 · ∞ out of the slabs.
  const float tiny = 1e-18;
  vec3 safe = vec3(a.x < tiny ? (direction.x < 0.0 ? -tiny : tiny) : direction.x,
                   a.y < tiny ? (direction.y < 0.0 ? -tiny : tiny) : direction.y,
                   a.z < tiny ? (direction.z < 0.0 ? -tiny : tiny) : direction.z);
  precise vec3 inverse = 1.0 / safe;
  s.inverse = inverse;
  return s;
}

// The greatest and least of three numbers that are not NaN (the built-in functions also see to those).
float greatest(vec3 v) {
  float xy = v.x > v.y ? v.x : v.y;
  return xy > v.z ? xy : v.z;
}
float least(vec3 v) {
  float xy = v.x < v.y ? v.x : v.y;
  return xy < v.z ? xy : v.z;
}

// Entry and exit along the ray of a box (already padded), given its planes in the order in which the ray meets them.
// Hit where x <= y.
vec2 slab_in_order(Shear s, vec3 near, vec3 far) {
  precise vec3 entry = (near - s.origin) * s.inverse;
  precise vec3 leave = (far - s.origin) * s.inverse;
  return vec2(greatest(entry), least(leave));
}

vec2 slab(Shear s, vec3 lo, vec3 hi) {
  bvec3 backwards = lessThan(s.inverse, vec3(0));
  return slab_in_order(s, mix(lo, hi, backwards), mix(hi, lo, backwards));
}

// Exact product p + e = a·b without a fused multiply (Dekker 1971, Veltkamp splitting at 12 bits).
void exact_product(float a, float b, out float p, out float e) {
  precise float product = a * b;
  precise float ta = 4097.0 * a, tb = 4097.0 * b;
  precise float ah = ta - (ta - a), bh = tb - (tb - b);
  precise float al = a - ah, bl = b - bh;
  precise float rest = ((ah * bh - product) + ah * bl + al * bh) + al * bl;
  p = product;
  e = rest;
}

// Sign-exact a·b − c·d where the rounded difference is 0.
float exact_difference(float a, float b, float c, float d) {
  float p, pe, q, qe;
  exact_product(a, b, p, pe);
  exact_product(c, d, q, qe);
  precise float difference = (p - q) + (pe - qe);
  return difference;
}

struct Edges {
  vec2 a, b, c;  // the corners, sheared: the ray goes through (0, 0)
  vec3 e;        // edge functions: inside where none have opposite signs
  vec3 z;        // distances of the corners along the ray
};

Edges edge_functions(Shear s, vec3 v0, vec3 v1, vec3 v2) {
  precise vec3 a = permute(v0 - s.origin, s.axis);
  precise vec3 b = permute(v1 - s.origin, s.axis);
  precise vec3 c = permute(v2 - s.origin, s.axis);
  precise float ax = a.x - s.sx * a.z, ay = a.y - s.sy * a.z;
  precise float bx = b.x - s.sx * b.z, by = b.y - s.sy * b.z;
  precise float cx = c.x - s.sx * c.z, cy = c.y - s.sy * c.z;
  precise float u = cx * by - cy * bx;
  precise float v = ax * cy - ay * cx;
  precise float w = bx * ay - by * ax;
  if (u == 0.0 || v == 0.0 || w == 0.0) {
    if (u == 0.0) u = exact_difference(cx, by, cy, bx);
    if (v == 0.0) v = exact_difference(ax, cy, ay, cx);
    if (w == 0.0) w = exact_difference(bx, ay, by, ax);
  }
  precise vec3 depth = s.sz * vec3(a.z, b.z, c.z);
  return Edges(vec2(ax, ay), vec2(bx, by), vec2(cx, cy), vec3(u, v, w), depth);
}

// The weights e/Σe put the hit where Σ e·(x, y)/Σe = 0. What rounding products adds to e breaks that by up to
// 2^-23·|product|/Σe of the triangle's extent: on a needle, or one seen edge-on, along its length, and t with it.
// Differences of exact products end that: what is left of the error is that of the sheared corners, as if the triangle
// itself had been moved by some ulps. Signs stay: rounding is monotone.
vec3 exact_where_ill_conditioned(Edges t) {
  vec3 p = abs(vec3(t.c.x * t.b.y, t.a.x * t.c.y, t.b.x * t.a.y)),
       q = abs(vec3(t.c.y * t.b.x, t.a.y * t.c.x, t.b.y * t.a.x));
  vec3 product = max(p, q);
  if (max(max(product.x, product.y), product.z) <= 4.0 * abs(t.e.x + t.e.y + t.e.z)) return t.e;
  return vec3(exact_difference(t.c.x, t.b.y, t.c.y, t.b.x), exact_difference(t.a.x, t.c.y, t.a.y, t.c.x),
              exact_difference(t.b.x, t.a.y, t.b.y, t.a.x));
}

struct TriangleHit {
  bool hit;
  float t;
  vec3 barycentric;  // weights of v0, v1, v2
  bool clockwise;    // the corners, seen along the ray: the back, unless the node mirrors
  float area;        // twice the triangle's, sheared; with any sign
};

// (v1 − v0)×(v2 − v0)·direction = −Σe/sz: the shear's determinant is sz, and Σe is minus twice the area of the sheared
// triangle.
bool is_clockwise(Shear s, float sum) { return (sum < 0.0) != (s.sz < 0.0); }

TriangleHit intersect_triangle(Shear s, vec3 v0, vec3 v1, vec3 v2, float pad, float tmin, float tmax) {
  TriangleHit result;
  result.hit = false;
  result.t = 0.0;
  result.barycentric = vec3(0);
  result.clockwise = false;
  result.area = 0.0;
  Edges edges = edge_functions(s, v0, v1, v2);
  vec3 e = edges.e, z = edges.z;
  if ((e.x < 0.0 || e.y < 0.0 || e.z < 0.0) && (e.x > 0.0 || e.y > 0.0 || e.z > 0.0)) return result;
  e = exact_where_ill_conditioned(edges);
  precise float det = e.x + e.y + e.z;
  if (det == 0.0) return result;
  precise float t = (e.x * z.x + e.y * z.y + e.z * z.z) / det;
  precise vec3 lo = min(min(v0, v1), v2) - pad;
  precise vec3 hi = max(max(v0, v1), v2) + pad;
  vec2 range = slab(s, lo, hi);
  t = t < range.x ? range.x : t;
  t = t > range.y ? range.y : t;
  result.hit = range.x <= range.y && t >= tmin && t <= tmax;  // false for a NaN
  result.t = t;
  result.clockwise = is_clockwise(s, det);
  result.area = det;
  precise vec3 weights = e / det;
  result.barycentric = weights;
  return result;
}

// The point of a triangle that a ray is known to hit (the rasteriser may have seen it just outside): weights not below
// 0.
TriangleHit project_to_triangle(Shear s, vec3 v0, vec3 v1, vec3 v2, float tmin) {
  TriangleHit result;
  Edges edges = edge_functions(s, v0, v1, v2);
  vec3 e = exact_where_ill_conditioned(edges), z = edges.z;
  float sum = e.x + e.y + e.z;
  result.clockwise = is_clockwise(s, sum);
  result.area = sum;
  e = sum < 0.0 ? max(-e, vec3(0)) : max(e, vec3(0));
  precise float det = e.x + e.y + e.z;
  if (!(det > 0.0)) {
    e = vec3(1);
    det = 3.0;
  }
  precise vec3 weights = e / det;
  precise float t = weights.x * z.x + weights.y * z.y + weights.z * z.z;
  result.hit = true;
  result.t = max(t, tmin);
  result.barycentric = weights;
  return result;
}
#endif
