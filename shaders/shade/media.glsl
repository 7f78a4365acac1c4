// SPDX-License-Identifier: MIT
// The stack of volumes a ray is inside: four bytes, top lowest, each the material's volume number (0: nothing).
#ifndef SHEAF_MEDIA_GLSL
#define SHEAF_MEDIA_GLSL
uint media_push(uint stack, uint volume) { return (stack << 8) | volume; }

uint media_remove(uint stack, uint volume) {  // the topmost entry that is this volume
  for (uint i = 0u; i < 4u; ++i) {
    uint shift = 8u * i;
    if (((stack >> shift) & 0xFFu) == volume) {
      uint below = i == 3u ? 0u : (stack >> (shift + 8u)) << shift;
      uint above = stack & ((1u << shift) - 1u);
      return below | above;
    }
  }
  return stack;
}
#endif
