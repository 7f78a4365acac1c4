// SPDX-License-Identifier: MIT
// Texture lookups from plain buffers: one filter, the same bits on every device and in every kernel.
#extension GL_EXT_control_flow_attributes : require
layout(constant_id = 9) const bool TEXTURED = true;

float srgb_to_linear(float c) { return c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4); }

int wrap_texel(int i, int size, uint mode) {
  if (mode == 2u) return clamp(i, 0, size - 1);
  int period = mode == 1u ? 2 * size : size;
  int m = i % period;
  if (m < 0) m += period;
  return m < size ? m : period - 1 - m;
}

struct Level {  // of a mip chain
  uint first_texel;
  uvec2 size;
};

Level level_of(TextureUse t, uint level) {
  Level l = Level(t.first_texel, uvec2(t.width, t.height));
  for (uint k = 0u; k < level; ++k) {
    l.first_texel += l.size.x * l.size.y;
    l.size = max(l.size / 2u, uvec2(1));
  }
  return l;
}

vec4 fetch_texel(Level l, uint flags, int x, int y, bool srgb) {
  uint xi = uint(wrap_texel(x, int(l.size.x), flags & 3u));
  uint yi = uint(wrap_texel(y, int(l.size.y), (flags >> 2) & 3u));
  vec4 c = unpackUnorm4x8(load_texel(l.first_texel + yi * l.size.x + xi));
  if (srgb) c.rgb = vec3(srgb_to_linear(c.r), srgb_to_linear(c.g), srgb_to_linear(c.b));
  return c;
}

vec4 sample_level(Level l, uint flags, vec2 uv, bool srgb) {
  // Far-off coordinates lose their fraction anyway; the clamp keeps the integer conversion defined.
  vec2 at = clamp(uv * vec2(l.size), vec2(-1e9), vec2(1e9));
  if ((flags & TEXTURE_NEAREST) != 0u) return fetch_texel(l, flags, int(floor(at.x)), int(floor(at.y)), srgb);
  at -= 0.5;
  vec2 base = floor(at), f = at - base;
  vec4 sum = vec4(0);
  [[dont_unroll]] for (int tap = 0; tap < 4; ++tap) {
    ivec2 corner = ivec2(tap & 1, tap >> 1);
    vec2 weight = mix(1.0 - f, f, notEqual(corner, ivec2(0)));
    sum += weight.x * weight.y * fetch_texel(l, flags, int(base.x) + corner.x, int(base.y) + corner.y, srgb);
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

// The mean over the footprint: up to MAX_TAPS taps along its longer diameter, each from the two levels whose texels are about as
// large as what is left to cover (Heckbert 1989 and McCormack et al. 1999, as graphics hardware does it).
const float MAX_TAPS = 8.0;

vec4 sample_filtered(TextureUse t, UvFootprint f, bool srgb) {
  vec2 size = vec2(t.width, t.height);
  float along = length(f.along * size), across = length(f.across * size);
  vec2 axis = along >= across ? f.along : f.across;
  float major = min(max(along, across), 1e9), minor = max(min(along, across), 1e-9);
  float taps = clamp(ceil(min(major / minor, major)), 1.0, MAX_TAPS);
  float lod = clamp(log2(max(major / taps, 1.0)), 0.0, float(t.levels - 1u));
  if (t.levels == 1u) taps = 1.0;
  uint level = uint(lod), levels = lod > float(level) ? 2u : 1u;
  uint flags = lod > 0.0 ? t.flags & ~TEXTURE_NEAREST : t.flags;  // "nearest" is how it is magnified
  vec4 sum = vec4(0);
  [[dont_unroll]] for (uint k = 0u; k < uint(taps) * levels; ++k) {
    uint upper = k % levels;
    float weight = levels == 1u ? 1.0 : upper == 1u ? lod - float(level) : 1.0 - (lod - float(level));
    float place = (float(k / levels) + 0.5) / taps - 0.5;
    sum += weight * sample_level(level_of(t, level + upper), flags, f.at + axis * place, srgb);
  }
  return sum / taps;
}

bool is_color(uint place) { return place == TEXTURE_BASE_COLOR || place == TEXTURE_EMISSIVE; }

// The image itself, unfiltered: what decides whether and how a ray passes. White where the material has no such texture.
vec4 look_up(uint material, uint place, vec2 uv0, vec2 uv1) {
  if (!TEXTURED || (materials[material].uses[place].flags & TEXTURE_HERE) == 0u) return vec4(1);
  TextureUse use = materials[material].uses[place];
  return sample_level(level_of(use, 0u), use.flags, transform_uv(use, uv0, uv1), is_color(place));
}

// The first `count` textures of a material. A loop that stays one: a lookup is a thousand instructions on a CPU device, and six
// copies of it take a driver seconds to compile.
void look_up_all(uint material, uint count, vec2 uv0, vec2 uv1, out vec4 texels[TEXTURES]) {
  for (uint k = 0u; k < TEXTURES; ++k) texels[k] = vec4(1);
  if (!TEXTURED) return;
  [[dont_unroll]] for (uint k = 0u; k < count; ++k) texels[k] = look_up(material, k, uv0, uv1);
}

// All of a material's textures, each its mean over the footprint.
void look_up_filtered(uint material, TexturePoint p, out vec4 texels[TEXTURES]) {
  for (uint k = 0u; k < TEXTURES; ++k) texels[k] = vec4(1);
  if (!TEXTURED) return;
  [[dont_unroll]] for (uint k = 0u; k < TEXTURES; ++k) {
    if ((materials[material].uses[k].flags & TEXTURE_HERE) == 0u) continue;
    TextureUse use = materials[material].uses[k];
    UvFootprint f = p.uv0;
    if ((use.flags & TEXTURE_UV1) != 0u) f = p.uv1;
    f = UvFootprint(turn_uv(use, f.at) + use.offset, turn_uv(use, f.along), turn_uv(use, f.across));
    texels[k] = sample_filtered(use, f, is_color(k));
  }
}
