// SPDX-License-Identifier: MIT
// Frames of adaptive samples, round by round: which pixels are sampled again, and what a round leaves.
#include <algorithm>
#include <cmath>

#include "frame/renderer.hpp"

namespace sheaf {

// The samples of this round of the tile's active pixels, as many at once as the lists hold.
bool Renderer::render_round(const FrameRequest& request, const Tile& tile, RenderedFrame& out) {
  const std::uint32_t active = list_active_pixels(tile);
  if (active == 0) return true;
  const std::uint32_t first = adaptive_->first_sample(), all = adaptive_->samples();
  if (layers_ && first == 0) render_layers(request, tile);
  std::uint32_t at_once = std::clamp(memory_.tile_pixels / active, 1U, all);
  for (std::uint32_t done = 0; done < all;) {
    const std::uint32_t samples = std::min(at_once, all - done);
    if (render_batch(request, {first + done, samples, samples * active}, tile, done + samples == all)) {
      done += samples;
      continue;
    }
    if (dump_ != nullptr) dump_->rewind();
    if (at_once == 1) return false;
    at_once /= 2;
    done = 0;
    begin_tile(tile);
  }
  store_round(tile);
  store_counts(tile, out);
  return true;
}

std::uint32_t Renderer::list_active_pixels(const Tile& tile) {
  const auto list = memory_.active_pixels.view<std::uint32_t>();
  std::uint32_t active = 0;
  constexpr std::uint32_t side = 8;  // block by block, so that neighbours in the list are neighbours in the picture
  for (std::uint32_t top = 0; top < tile.height; top += side)
    for (std::uint32_t left = 0; left < tile.width; left += side)
      for (std::uint32_t y = top; y < std::min(top + side, tile.height); ++y)
        for (std::uint32_t x = left; x < std::min(left + side, tile.width); ++x)
          if (adaptive_->active(std::size_t{tile.y + y} * settings_.width + tile.x + x))
            list[active++] = y * tile.width + x;
  return active;
}

void Renderer::store_round(const Tile& tile) {
  const auto sums = memory_.accumulation_readback.view<std::uint64_t>();
  for (std::uint32_t i = 0; i < tile.pixels(); ++i) {
    const std::size_t pixel = std::size_t{tile.y + i / tile.width} * settings_.width + tile.x + i % tile.width;
    if (!adaptive_->active(pixel)) continue;
    glm::dvec4 sum(0);
    for (int c = 0; c < 4; ++c)
      sum[c] = std::ldexp(static_cast<double>(sums[std::size_t{i} * 4 + static_cast<std::size_t>(c)]), -32);
    adaptive_->add(pixel, sum);
  }
}

void Renderer::store_adaptive(RenderedFrame& out) const {
  for (std::size_t pixel = 0; pixel < out.layers.rgba.size() / 4; ++pixel) {
    const glm::dvec4 mean = adaptive_->mean(pixel);
    for (int c = 0; c < 3; ++c) out.layers.rgba[pixel * 4 + static_cast<std::size_t>(c)] = static_cast<float>(mean[c]);
    out.layers.rgba[pixel * 4 + 3] = std::min(static_cast<float>(mean.a), 1.0F);
  }
}

}  // namespace sheaf
