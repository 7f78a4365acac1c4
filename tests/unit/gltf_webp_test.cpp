// SPDX-License-Identifier: MIT
// EXT_texture_webp: images that the test encodes by libwebp, without loss.
#include <webp/encode.h>

#include "core/error.hpp"
#include "gltf_support.hpp"
#include "scene/image_codec.hpp"

namespace sheaf {
namespace {

using namespace test;
using Bytes = std::vector<std::uint8_t>;

Bytes texels(int width, int height) {
  Bytes rgba;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (const int value : {x * 37, y * 53, (x ^ y) * 11, 255 - x - y})
        rgba.push_back(static_cast<std::uint8_t>(value));
  return rgba;
}

Bytes webp(const Bytes& rgba, int width, int height) {
  std::uint8_t* out = nullptr;
  const std::size_t size = WebPEncodeLosslessRGBA(rgba.data(), width, height, width * 4, &out);
  Bytes file(out, out + size);
  WebPFree(out);
  return file;
}

struct WebpScene {
  GltfBuilder b = whole_document();
  explicit WebpScene(const Bytes& file) {
    const int image = b.add("images", {{"bufferView", b.view(file)}, {"mimeType", "image/webp"}});
    b.add("textures", {{"extensions", {{"EXT_texture_webp", {{"source", image}}}}}});
    b.doc["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
    b.doc["meshes"][0]["primitives"][0]["material"] = 0;
    b.doc["extensionsUsed"] = b.doc["extensionsRequired"] = {"EXT_texture_webp"};
  }
  void expect_refused(const std::string& text, const LoadLimits& limits = {}) {
    try {
      (void)load(b, {}, limits);
      ADD_FAILURE() << "was read, and should say: " << text;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
    }
  }
};

TEST(GltfWebp, LosslessTexelsAreExact) {
  const Bytes rgba = texels(19, 7);
  WebpScene file(webp(rgba, 19, 7));
  const Scene scene = load(file.b);
  ASSERT_EQ(scene.images.size(), 1u);
  EXPECT_EQ(scene.images[0].width, 19u);
  EXPECT_EQ(scene.images[0].height, 7u);
  EXPECT_EQ(scene.images[0].rgba, rgba);
  EXPECT_EQ(scene.textures.at(0).image, 0u);
}

TEST(GltfWebp, IsPreferredToTheTexturesOwnImage) {
  const Bytes rgba = texels(4, 4);
  WebpScene scene(webp(rgba, 4, 4));
  scene.b.doc["textures"][0]["source"] = scene.b.add("images", {{"uri", "absent.png"}});
  scene.b.doc.erase("extensionsRequired");
  const Scene loaded = load(scene.b);
  EXPECT_EQ(loaded.images.at(0).rgba, rgba);
}

TEST(GltfWebp, DamageAndLimitsAreNamed) {
  const Bytes whole = webp(texels(64, 64), 64, 64);
  WebpScene(Bytes(whole.begin(), whole.begin() + 20)).expect_refused("images[0]: is not a valid WebP file");
  WebpScene(Bytes(whole.begin(), whole.end() - 30)).expect_refused("images[0]: cannot be decoded: it is damaged");
  LoadLimits limits;
  limits.image_side = 63;
  WebpScene(whole).expect_refused("images[0]: 64 x 64 pixels, a side may have 63", limits);
  limits = {};
  limits.texture_bytes = 64 * 64 * 4 - 1;
  WebpScene(whole).expect_refused("images[0]: the decoded images exceed", limits);
}

TEST(GltfWebp, AnAnimationIsNoImage) {
  // An extended header that says so, for a canvas of 1 x 1.
  const Bytes file = {'R', 'I', 'F', 'F', 22, 0, 0, 0, 'W', 'E', 'B', 'P', 'V', 'P', '8',
                      'X', 10,  0,   0,   0,  2, 0, 0, 0,   0,   0,   0,   0,   0,   0};
  EXPECT_EQ(read_webp_head(file).fault, "is a WebP animation, not an image");
}

}  // namespace
}  // namespace sheaf
