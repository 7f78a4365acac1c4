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

vec4 fetch_texel(TextureUse t, int x, int y, bool srgb) {
  uint xi = uint(wrap_texel(x, int(t.width), t.flags & 3u));
  uint yi = uint(wrap_texel(y, int(t.height), (t.flags >> 2) & 3u));
  vec4 c = unpackUnorm4x8(load_texel(t.first_texel + yi * t.width + xi));
  if (srgb) c.rgb = vec3(srgb_to_linear(c.r), srgb_to_linear(c.g), srgb_to_linear(c.b));
  return c;
}

vec4 sample_texture(TextureUse t, vec2 uv, bool srgb) {
  vec2 size = vec2(t.width, t.height);
  // Far-off coordinates lose their fraction anyway; the clamp keeps the integer conversion defined.
  vec2 at = clamp(uv * size, vec2(-1e9), vec2(1e9));
  if ((t.flags & TEXTURE_NEAREST) != 0u) return fetch_texel(t, int(floor(at.x)), int(floor(at.y)), srgb);
  at -= 0.5;
  vec2 base = floor(at), f = at - base;
  vec4 sum = vec4(0);
  [[dont_unroll]] for (int tap = 0; tap < 4; ++tap) {
    ivec2 corner = ivec2(tap & 1, tap >> 1);
    vec2 weight = mix(1.0 - f, f, notEqual(corner, ivec2(0)));
    sum += weight.x * weight.y * fetch_texel(t, int(base.x) + corner.x, int(base.y) + corner.y, srgb);
  }
  return sum;
}

vec2 transform_uv(TextureUse use, vec2 uv0, vec2 uv1) {
  vec2 uv = ((use.flags & TEXTURE_UV1) != 0u ? uv1 : uv0) * use.scale;
  return vec2(use.turn.x * uv.x + use.turn.y * uv.y, -use.turn.y * uv.x + use.turn.x * uv.y) + use.offset;
}

// White where the material has no such texture.
vec4 look_up(uint material, uint place, vec2 uv0, vec2 uv1) {
  if (!TEXTURED || (materials[material].uses[place].flags & TEXTURE_HERE) == 0u) return vec4(1);
  TextureUse use = materials[material].uses[place];
  return sample_texture(use, transform_uv(use, uv0, uv1), place == TEXTURE_BASE_COLOR || place == TEXTURE_EMISSIVE);
}

// The first `count` textures of a material. A loop that stays one: a lookup is a thousand instructions on a CPU device, and six
// copies of it take a driver seconds to compile.
void look_up_all(uint material, uint count, vec2 uv0, vec2 uv1, out vec4 texels[TEXTURES]) {
  for (uint k = 0u; k < TEXTURES; ++k) texels[k] = vec4(1);
  if (!TEXTURED) return;
  [[dont_unroll]] for (uint k = 0u; k < count; ++k) texels[k] = look_up(material, k, uv0, uv1);
}
