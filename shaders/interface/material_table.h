// SPDX-License-Identifier: MIT
// Parameters and textures of materials, one line each, for the loader, the scene, the device's layout and the shaders.
#ifndef SHEAF_MATERIAL_TABLE_H
#define SHEAF_MATERIAL_TABLE_H

// X(type, words, field, default, owner, key, low, high): what shaders read as the file gives it, in the order of its
// words on the device, which are an even number. `owner` is the glTF object that has `key`: `material`, its
// `pbrMetallicRoughness`, or one of its extensions. A value outside low … high is brought inside, with a warning.
#define MATERIAL_FACTORS(X)                                                              \
  X(vec4, 4u, base_color, 1.0f, pbrMetallicRoughness, baseColorFactor, 0, 1)             \
  X(vec3, 3u, emissive, 0.0f, material, emissiveFactor, 0, 1)                            \
  X(float, 1u, metallic, 1.0f, pbrMetallicRoughness, metallicFactor, 0, 1)               \
  X(float, 1u, roughness, 1.0f, pbrMetallicRoughness, roughnessFactor, 0, 1)             \
  X(float, 1u, alpha_cutoff, 0.5f, material, alphaCutoff, 0, 3.4028234e38)               \
  X(float, 1u, transmission, 0.0f, KHR_materials_transmission, transmissionFactor, 0, 1) \
  X(float, 1u, ior, 1.5f, KHR_materials_ior, ior, 1, 1000)

// X(number, place, field, owner, key, content): `place` in Material::uses, where what shadow rays ask comes first;
// `content`: colours, encoded as sRGB, or data.
#define MATERIAL_TEXTURES(X)                                                                                       \
  X(0u, TEXTURE_BASE_COLOR, base_color_texture, pbrMetallicRoughness, baseColorTexture, CONTENT_COLOR)             \
  X(1u, TEXTURE_METALLIC_ROUGHNESS, metallic_roughness_texture, pbrMetallicRoughness, metallicRoughnessTexture,    \
    CONTENT_DATA)                                                                                                  \
  X(2u, TEXTURE_TRANSMISSION, transmission_texture, KHR_materials_transmission, transmissionTexture, CONTENT_DATA) \
  X(3u, TEXTURE_NORMAL, normal_texture, material, normalTexture, CONTENT_DATA)                                     \
  X(4u, TEXTURE_OCCLUSION, occlusion_texture, material, occlusionTexture, CONTENT_DATA)                            \
  X(5u, TEXTURE_EMISSIVE, emissive_texture, material, emissiveTexture, CONTENT_COLOR)

#define CONTENT_DATA 0u
#define CONTENT_COLOR 1u

#endif
