// SPDX-License-Identifier: MIT
// Texture lookups from plain buffers: one filter, the same bits on every device and in every kernel.
layout(constant_id = 9) const bool TEXTURED = true;
BUFFER(ROLE_TEXTURES, readonly, Texture, textures);
BUFFER(ROLE_TEXELS, readonly, uint, texels);

float srgb_to_linear(float c) { return c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4); }

int wrap_texel(int i, int size, uint mode) {
  if (mode == 2u) return clamp(i, 0, size - 1);
  int period = mode == 1u ? 2 * size : size;
  int m = i % period;
  if (m < 0) m += period;
  return m < size ? m : period - 1 - m;
}

vec4 fetch_texel(Texture t, int x, int y, bool srgb) {
  uint xi = uint(wrap_texel(x, int(t.width), t.flags & 3u));
  uint yi = uint(wrap_texel(y, int(t.height), (t.flags >> 2) & 3u));
  vec4 c = unpackUnorm4x8(texels[t.first_texel + yi * t.width + xi]);
  if (srgb) c.rgb = vec3(srgb_to_linear(c.r), srgb_to_linear(c.g), srgb_to_linear(c.b));
  return c;
}

vec4 sample_texture(uint index, vec2 uv, bool srgb) {
  Texture t = textures[index];
  vec2 size = vec2(t.width, t.height);
  // Far-off coordinates lose their fraction anyway; the clamp keeps the integer conversion defined.
  vec2 at = clamp(uv * size, vec2(-1e9), vec2(1e9));
  if ((t.flags & 16u) != 0u) return fetch_texel(t, int(floor(at.x)), int(floor(at.y)), srgb);
  at -= 0.5;
  vec2 base = floor(at), f = at - base;
  int x = int(base.x), y = int(base.y);
  vec4 top = mix(fetch_texel(t, x, y, srgb), fetch_texel(t, x + 1, y, srgb), f.x);
  vec4 bottom = mix(fetch_texel(t, x, y + 1, srgb), fetch_texel(t, x + 1, y + 1, srgb), f.x);
  return mix(top, bottom, f.y);
}

vec2 transform_uv(TextureUse use, vec2 uv0, vec2 uv1) {
  vec2 uv = (use.uv_set == 1u ? uv1 : uv0) * use.scale;
  float c = cos(use.rotation), s = sin(use.rotation);
  return vec2(c * uv.x + s * uv.y, -s * uv.x + c * uv.y) + use.offset;
}

vec4 look_up(TextureUse use, vec2 uv0, vec2 uv1, bool srgb) {
  return !TEXTURED || use.texture == NO_INDEX ? vec4(1) : sample_texture(use.texture, transform_uv(use, uv0, uv1), srgb);
}
