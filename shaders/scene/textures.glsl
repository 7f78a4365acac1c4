// SPDX-License-Identifier: MIT
// Texture lookups from plain buffers: one filter, the same bits on every device and in every kernel.
#ifndef SHEAF_TEXTURES_GLSL
#define SHEAF_TEXTURES_GLSL
#include "scene/memory.glsl"
#include "lib/convert.glsl"
layout(constant_id = SPEC_TEXTURED) const bool TEXTURED = true;

// Bytes of sRGB (IEC 61966-2-1). Above the linear part ((b/255 + 0.055)/1.055)^2.4 = s^5 · s^-0.2, s its square root;
// the last factor is a polynomial of s − 1 of least greatest relative error over all bytes: 1.3e-6, as close as `pow`
// is; 255 gives 1.
vec3 srgb_to_linear(vec3 b) {
  const float factors[8] =
      float[](2.6782398, 5.6563973, 5.2597384, 2.4563444, 0.74564469, 0.0095650116, 0.12670356, -0.19984418);
  vec3 y = b * (1.0 / (255.0 * 1.055)) + 0.055 / 1.055, s = sqrt(y), x = s - 1.0, p = vec3(factors[0]);
  for (uint k = 1u; k < 8u; ++k) p = p * x + factors[k];
  p = p * x + 1.0;
  return mix(y * y * s * p, b * (1.0 / (255.0 * 12.92)), lessThanEqual(b, vec3(10.0)));
}

vec4 bytes_of(uint word) { return vec4(ivec4(word & 255u, (word >> 8) & 255u, (word >> 16) & 255u, word >> 24)); }

// Texel i and the next. Whole numbers up to 2^23 as floats: a remainder of integers is a division a lane on a CPU
// device. All is exact but the quotient, and its floor is off by one at most.
vec2 wrap_two(float i, float size, uint mode) {
  if (mode == 2u) return clamp(vec2(i, i + 1.0), 0.0, size - 1.0);
  float period = mode == 1u ? 2.0 * size : size;
  float m = i - period * floor(i / period);
  m = m < 0.0 ? m + period : m >= period ? m - period : m;
  vec2 p = vec2(m, m + 1.0 < period ? m + 1.0 : 0.0);
  return mix(period - 1.0 - p, p, lessThan(p, vec2(size)));
}

struct Level {  // of a mip chain
  uint first_texel;
  uvec2 size;
};

Level next_level(Level l) { return Level(l.first_texel + l.size.x * l.size.y, max(l.size / 2u, uvec2(1))); }

Level level_of(TextureUse t, uint level) {
  Level l = Level(t.first_texel, uvec2(t.width, t.height));
  for (uint k = 0u; k < level; ++k) l = next_level(l);
  return l;
}

vec4 sample_level(Level l, uint flags, vec2 uv, bool srgb) {
  vec2 size = vec2(l.size);
  // Coordinates further off have lost their fraction, and so what there is to interpolate.
  vec2 at = clamp(uv * size, vec2(-8388000.0), vec2(8388000.0));
  bool nearest = (flags & TEXTURE_NEAREST) != 0u;
  if (!nearest) at -= 0.5;
  vec2 base = floor(at), f = nearest ? vec2(0) : at - base;
  uint mode_x = flags & 3u, mode_y = (flags >> 2) & 3u;
  uvec2 x = to_uint(wrap_two(base.x, size.x, mode_x)), y = to_uint(wrap_two(base.y, size.y, mode_y));
  uint taps = nearest ? 1u : 4u;
  vec4 sum = vec4(0);
  [[dont_unroll]] for (uint tap = 0u; tap < taps; ++tap) {
    bool right = (tap & 1u) != 0u, low = (tap & 2u) != 0u;
    vec4 c = bytes_of(load_texel(l.first_texel + (low ? y.y : y.x) * l.size.x + (right ? x.y : x.x)));
    c = vec4(srgb ? srgb_to_linear(c.rgb) : c.rgb / 255.0, c.a / 255.0);
    sum += (right ? f.x : 1.0 - f.x) * (low ? f.y : 1.0 - f.y) * c;
  }
  return sum;
}

vec2 turn_uv(TextureUse use, vec2 uv) {
  uv *= use.scale;
  return vec2(use.turn.x * uv.x + use.turn.y * uv.y, -use.turn.y * uv.x + use.turn.x * uv.y);
}

vec2 transform_uv(TextureUse use, vec2 uv0, vec2 uv1) {
  return turn_uv(use, (use.flags & TEXTURE_UV1) != 0u ? uv1 : uv0) + use.offset;
}

struct UvFootprint {  // a point, and the diameters of the footprint around it
  vec2 at, along, across;
};

struct TexturePoint {
  UvFootprint uv0, uv1;
};

// The mean over the footprint: up to MAX_TAPS taps along its longer diameter, each from the two levels whose texels are
// about as large as what is left to cover (Heckbert 1989 and McCormack et al. 1999, as graphics hardware does it).
const float MAX_TAPS = 8.0;

vec4 sample_filtered(TextureUse t, UvFootprint f, bool srgb) {
  vec2 size = vec2(t.width, t.height);
  float along = length(f.along * size), across = length(f.across * size);
  vec2 axis = along >= across ? f.along : f.across;
  float major = min(max(along, across), 1e9), minor = max(min(along, across), 1e-9);
  float taps = clamp(ceil(min(major / minor, major)), 1.0, MAX_TAPS);
  float lod = clamp(log2(max(major / taps, 1.0)), 0.0, float(t.levels - 1u));
  if (t.levels == 1u) taps = 1.0;
  uint level = to_uint(floor(lod)), levels = lod > float(level) ? 2u : 1u;
  uint flags = lod > 0.0 ? t.flags & ~TEXTURE_NEAREST : t.flags;  // "nearest" is how it is magnified
  Level lower = level_of(t, level), upper = next_level(lower);
  float share = lod - float(level);  // of the upper level
  vec4 sum = vec4(0);
  [[dont_unroll]] for (uint k = 0u; k < to_uint(taps) * levels; ++k) {
    bool up = k >= to_uint(taps);
    float place = (float(int(up ? k - to_uint(taps) : k)) + 0.5) / taps - 0.5;
    Level l = Level(up ? upper.first_texel : lower.first_texel, up ? upper.size : lower.size);
    sum += (up ? share : 1.0 - share) * sample_level(l, flags, f.at + axis * place, srgb);
  }
  return sum / taps;
}

bool is_color(uint place) { return (COLOR_TEXTURES >> place & 1u) != 0u; }

// The image itself, unfiltered: what decides whether and how a ray passes. White where the material has no such
// texture.
vec4 look_up(uint material, uint place, vec2 uv0, vec2 uv1) {
  if (!TEXTURED) return vec4(1);
  TextureUse use = load_use(material, place);
  if ((use.flags & TEXTURE_HERE) == 0u) return vec4(1);
  return sample_level(level_of(use, 0u), use.flags, transform_uv(use, uv0, uv1), is_color(place));
}

// The first `count` textures of a material. A loop that stays one: a lookup is a thousand instructions on a CPU device,
// and six copies of it take a driver seconds to compile.
void look_up_all(uint material, uint count, vec2 uv0, vec2 uv1, out vec4 texels[TEXTURES]) {
  for (uint k = 0u; k < TEXTURES; ++k) texels[k] = vec4(1);
  if (!TEXTURED) return;
  [[dont_unroll]] for (uint k = 0u; k < count; ++k) texels[k] = look_up(material, k, uv0, uv1);
}
#endif
