// SPDX-License-Identifier: MIT
// Raster on CPU devices: a triangle per lane, larger ones along their spans, by the test that traced rays make.
#pragma once

#include "device_data/features.hpp"
#include "vulkan/recorder.hpp"

namespace sheaf {

class RasterSpans {
 public:
  RasterSpans() = default;
  RasterSpans(const Device& device, const Plan& plan, const Features& features);

  /// Whether it is to draw in place of the graphics pipeline: on CPU devices, or as SHEAF_RASTER (pipeline, spans)
  /// says.
  [[nodiscard]] static bool pays(const Device& device);

  [[nodiscard]] explicit operator bool() const { return static_cast<bool>(kernel_); }
  /// The visibility buffer is bound and cleared.
  void record(Recorder& recorder, const Buffer& visibility, std::uint32_t triangles) const;

 private:
  Kernel kernel_;
};

}  // namespace sheaf
