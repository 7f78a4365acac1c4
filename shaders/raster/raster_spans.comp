// SPDX-License-Identifier: MIT
#version 460
#extension GL_GOOGLE_include_directive : require
// Raster for CPU devices, whose driver sets up a triangle at a time on one thread: a triangle a lane is placed in the
// picture; one of few samples is tested by its lane, a sample after the other, a larger one by all lanes of its
// subgroup, along its spans.
//
// Outlines only choose which samples are tested, and err to the outside: whether a triangle is there, and at which t,
// is the test that traced rays make. So the picture is that of traced rays to the last bit.
//
// How far outlines reach. The test takes a ray through a triangle whose corners moved by rounding: by less than ε|v|, v
// the corner as seen from the eye, ε = 2^-21 (three roundings of the sheared corners, three of the ray's direction).
// What is computed here from v rounds by no more. Hence what is said below of pixels and of edge functions, with ε to
// spare.
#define COMPUTE
#include "lib/common.glsl"
#include "interface/push/raster.h"
#include "lib/push.glsl"
#include "lists/rays.glsl"
#include "scene/scene.glsl"
#include "raster/camera.glsl"
#include "scene/attributes.glsl"
#include "lib/convert.glsl"
layout(constant_id = SPEC_MASKED) const bool MASKED = true;
#include "lib/lanes.glsl"
BUFFER(ROLE_VISIBILITY, coherent, uint64_t, visibility);
layout(buffer_reference, scalar, buffer_reference_align = 4) coherent buffer OneFloat { float v; };
PUSH(RasterSpansPush);

const float EPSILON = 4.76837158203125e-7;  // 2^-21
const uint FEW = 48u;                       // samples of a rectangle that a lane tests alone

// Pixels of the tile, from 0 at the centre of sample (0, 0): x/w and y/w of a corner. w is the depth, or 1.
struct Screen {
  vec2 scale, centre;  // x = scale.x · (v·right)/(right·right) + centre.x · w
  vec2 reach;          // how much of |v| x and y may be
  vec2 aside;          // off the middle by a pixel, the way to depth 1 goes so much aside
  float top, bottom;   // rows of this workgroup
};

struct Outline {
  vec2 lo, hi;       // pixels, inclusive; nothing where lo exceeds hi
  vec3 a, b, c;      // edge k: a[k] x + b[k] y + c[k], inside not below 0 where `front`, nor above where `back`
  vec3 slack;        // but for this
  bool front, back;  // both where rounding hides which
  float nearest;     // no depth below this
  vec3 inverse;      // nor any whose inverse is above inverse · (x, y, 1)
};

Screen screen;

Screen screen_of(uint band) {
  vec2 size = vec2(frame.width, frame.height);
  Screen s;
  s.scale = 0.5 * size * vec2(1.0, -1.0);
  s.centre = 0.5 * size - frame.place - vec2(frame.tile_x, frame.tile_y);
  s.reach = 0.5 * size / vec2(length(frame.right), length(frame.up)) + size;
  s.aside = 2.0 * vec2(length(frame.right), length(frame.up)) / size;
  s.top = float(frame.tile_height * band / push.bands);
  s.bottom = float(frame.tile_height * (band + 1u) / push.bands) - 1.0;
  return s;
}

float depth_of(vec3 v) { return dot(v, frame.forward); }

vec3 on_screen(vec3 v) {
  float x = dot(v, frame.right) / dot(frame.right, frame.right), y = dot(v, frame.up) / dot(frame.up, frame.up);
  float w = frame.orthographic != 0u ? 1.0 : depth_of(v);
  return vec3(screen.scale * vec2(x, y) + screen.centre * w, w);
}

// How far from `at` a corner may be seen. Moved by ε|v| at depth w: ε|v|/w · |v|/w · scale; computed to 2^-22 of its
// distance from the middle; the rays' directions lie within 2^-22 of the picture's width (at most 16384 pixels) of
// their samples.
float pad_of(float size, vec3 p, vec2 at) {
  float r = size / p.z;
  return 4.0 * EPSILON * (r * r * max(screen.reach.x, screen.reach.y) + abs(at.x) + abs(at.y)) + 0.015625;
}

void set_sides(float turn, float unsure, inout Outline o) {
  o.front = !(turn < -unsure);
  o.back = !(turn > unsure);
}

// Corners in the picture, each within `pad` of its place: the edge from P to Q is off by no more than pad (|a| + |b|)
// where the triangle is. The inverse of depth is linear there: between those of the corners by the edges' shares of the
// area.
void outline_in_picture(vec2 a, vec2 b, vec2 c, vec3 w, float pad, inout Outline o) {
  o.a = vec3(b.y - c.y, c.y - a.y, a.y - b.y);
  o.b = vec3(c.x - b.x, a.x - c.x, b.x - a.x);
  o.c = -(o.a * vec3(b.x, c.x, a.x) + o.b * vec3(b.y, c.y, a.y));
  vec3 sides = abs(o.a) + abs(o.b);
  o.slack = pad * sides;
  float area = o.a.x * a.x + o.b.x * a.y + o.c.x, all = sides.x + sides.y + sides.z;
  set_sides(area, 2.0 * pad * all, o);
  vec3 inverse = 1.0 / w;
  float share = all / abs(area), most = greatest(inverse),
        reach = greatest(abs(vec3(a.x, b.x, c.x))) + greatest(abs(vec3(a.y, b.y, c.y)));
  if (!(pad * share < 0.125)) return;
  float off = 4.0 * pad * share * (most - least(inverse)) + (4.0 * EPSILON * share * reach + 1.52587890625e-5) * most;
  o.inverse = vec3(dot(o.a, inverse), dot(o.b, inverse), dot(o.c, inverse)) / area + vec3(0.0, 0.0, off);
}

// Corners beside or behind the eye: edges as planes through it. Three products of two terms, each off by 4ε of what |v|
// allows.
void outline_in_space(vec3 p, vec3 q, vec3 r, vec3 size, inout Outline o) {
  vec3 bc = cross(q, r), ca = cross(r, p), ab = cross(p, q);
  o.a = vec3(bc.x, ca.x, ab.x);
  o.b = vec3(bc.y, ca.y, ab.y);
  o.c = vec3(bc.z, ca.z, ab.z);
  o.slack = 16.0 * EPSILON * screen.reach.x * screen.reach.y * size.yzx * size.zxy;
  float turn = dot(bc, p), unsure = 2.0 * o.slack.x * size.x, surely = abs(turn) - unsure;
  set_sides(turn, unsure, o);
  // The sum of the edge functions, times the depth of the triangle's plane there, is their determinant.
  vec3 sum = bc + ca + ab;
  sum = turn < 0.0 ? -sum : sum;
  sum.z += o.slack.x + o.slack.y + o.slack.z;
  if (surely > 0.0) o.inverse = (1.0 + 64.0 * EPSILON) / surely * sum;
}

Outline outline_of(Corners t) {
  vec3 a = t.a - frame.eye, b = t.b - frame.eye, c = t.c - frame.eye;
  vec3 size = vec3(length(a), length(b), length(c)), depth = vec3(depth_of(a), depth_of(b), depth_of(c));
  vec3 p = on_screen(a), q = on_screen(b), r = on_screen(c);
  if (frame.orthographic != 0u) size += length(frame.right) + length(frame.up) + 1.0;
  vec3 off = 4.0 * EPSILON * size, w = vec3(p.z, q.z, r.z);
  Outline o;
  o.nearest = least(depth - off) - 4.0 * frame.box_pad;
  o.inverse = vec3(0.0, 0.0, INFINITY);
  o.lo = vec2(0.0, screen.top);
  o.hi = vec2(float(frame.tile_width) - 1.0, screen.bottom);
  vec2 at_a = p.xy / p.z, at_b = q.xy / q.z, at_c = r.xy / r.z;
  float pad = max(max(pad_of(size.x, p, at_a), pad_of(size.y, q, at_b)), pad_of(size.z, r, at_c));
  bool ahead = least(w) > 0.0;
  if (ahead && pad < 1e6) {
    o.lo = max(o.lo, ceil(min(min(at_a, at_b), at_c) - pad));
    o.hi = min(o.hi, floor(max(max(at_a, at_b), at_c) + pad));
  }
  if (ahead && pad < 1.0)
    outline_in_picture(at_a, at_b, at_c, w, pad, o);
  else
    outline_in_space(p, q, r, size, o);
  if (frame.orthographic != 0u) o.inverse = vec3(0.0, 0.0, INFINITY);  // w is not the depth
  if (greatest(depth + off) < frame.near * (1.0 - 4.0 * EPSILON) || o.nearest > frame.far * (1.0 + 4.0 * EPSILON))
    o.hi.x = -1.0;
  return o;
}

// Where row y of the outline begins and ends.
void span_between(Outline o, float y, float side, inout vec2 span) {
  vec2 s = vec2(o.lo.x, o.hi.x);
  for (uint k = 0u; k < 3u; ++k) {
    float a = side * o.a[k], rest = side * (o.b[k] * y + o.c[k]) + o.slack[k];
    float at = -rest / a;
    s.x = a > 0.0 ? max(s.x, ceil(at - 0.015625)) : s.x;
    s.y = a < 0.0 ? min(s.y, floor(at + 0.015625)) : s.y;
    s.y = a == 0.0 && rest < 0.0 ? -1.0 : s.y;
  }
  if (s.x <= s.y) span = vec2(min(span.x, s.x), max(span.y, s.y));
}

vec2 span_of(Outline o, float y) {
  vec2 span = vec2(1e9, -1.0);
  if (y > o.hi.y) return span;
  if (o.front) span_between(o, y, 1.0, span);
  if (o.back) span_between(o, y, -1.0, span);
  return span;
}

void test_sample(vec2 place, Outline o, Corners corners, uint triangle) {
  uvec2 at = to_uint(place);
  uint pixel = at.y * frame.tile_width + at.x;
  // Only ever falls: a stale value costs a test, nothing else.
  float seen = OneFloat(pack64(push.shown) + uint64_t(8u * pixel + 4u)).v;
  vec2 aside = (place - screen.centre) * screen.aside;
  float below = (dot(o.inverse.xy, place) + o.inverse.z) * seen;
  if (o.nearest > seen || below * below < 1.0 + dot(aside, aside)) return;
  Ray ray = camera_ray(frame.tile_x + at.x, frame.tile_y + at.y, frame.place);
  // No further than what is seen; before there is anything, that is a NaN.
  TriangleHit h =
      seen_corners(make_shear(ray.origin, ray.direction), corners, ray.tmin, seen < ray.tmax ? seen : ray.tmax);
  if (!h.hit) return;
  uint64_t found = (uint64_t(floatBitsToUint(h.t) & 0x7FFFFFFFu) << 32) | uint64_t(triangle);
  if (MASKED && (corners.instance & TRIANGLE_MASKED) != 0u && masked_out(triangle, h.barycentric)) return;
  atomicMin(visibility[pixel], found);
}

bool may_hold(Outline o, vec2 at) {
  vec3 e = o.a * at.x + o.b * at.y + o.c;
  return (o.front && least(e + o.slack) >= 0.0) || (o.back && greatest(e - o.slack) <= 0.0);
}

void test_rectangle(Outline o, Corners corners, uint triangle) {
  vec2 at = o.lo;
  while (at.y <= o.hi.y) {
    if (may_hold(o, at)) test_sample(at, o, corners, triangle);
    at = at.x < o.hi.x ? vec2(at.x + 1.0, at.y) : vec2(o.lo.x, at.y + 1.0);
  }
}

#define FROM(value) OF_LANE(value, from)

// All lanes along the spans of one lane's triangle: first a row per lane, then a sample per lane.
void test_spans(uint from, Outline mine, Corners own, uint own_triangle) {
  Outline o = Outline(FROM(mine.lo), FROM(mine.hi), FROM(mine.a), FROM(mine.b), FROM(mine.c), FROM(mine.slack),
                      FROM(mine.front), FROM(mine.back), FROM(mine.nearest), FROM(mine.inverse));
  Corners corners = Corners(FROM(own.a), FROM(own.b), FROM(own.c), FROM(own.instance));
  uint triangle = FROM(own_triangle);
  float lane = float(gl_SubgroupInvocationID);
  for (float top = o.lo.y; top <= o.hi.y; top += float(LANES)) {
    vec2 spans = span_of(o, top + lane);
    float rows = min(float(LANES), o.hi.y - top + 1.0);
    for (uint row = 0u; float(row) < rows; ++row) {
      vec2 span = OF_LANE(spans, row);
      for (float x = span.x; x <= span.y; x += float(LANES)) {
        float at = x + lane;
        if (at <= span.y) test_sample(vec2(at, top + float(row)), o, corners, triangle);
      }
    }
  }
}

void main() {
  // Neighbours go to different threads: what is seen large is so for many in a row.
  uint blocks = group_count() / push.bands,
       first = remap_workgroup(group_number() / push.bands, blocks, WORKERS, 0u) * gl_WorkGroupSize.x;
  if (group_number() >= blocks * push.bands || first >= frame.triangles) return;
  uint triangle = first + local_index();
  bool is_active = triangle < frame.triangles;
  triangle = min(triangle, frame.triangles - 1u);
  screen = screen_of(group_number() % push.bands);
  Corners corners = load_triangle(triangle);
  Outline o = outline_of(corners);
  vec2 extent = o.hi - o.lo + 1.0;
  is_active = is_active && extent.x > 0.0 && extent.y > 0.0;
  bool few = extent.x * extent.y <= float(FEW);
  if (is_active && few) test_rectangle(o, corners, triangle);
  bool large = is_active && !few;
  while (any_lane(large)) {
    uint from = LANES > 32u ? subgroupBallotFindLSB(subgroupBallot(large)) : lowest_bit(lanes_where(large));
    test_spans(from, o, corners, triangle);
    large = large && gl_SubgroupInvocationID != from;
  }
}
