// SPDX-License-Identifier: MIT
// Camera paths, our own and Nerfstudio's, and where the camera is at a few times.
#include "scene/camera_path.hpp"

#include <cmath>

#include "core/error.hpp"
#include "target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sheaf;
  try {
    const CameraPath path = parse_camera_path(std::string(fuzz::as_text(data, size)), "path.json");
    fuzz::require(!path.keys.empty(), "a path has a key");
    for (const double time : {-1.0, 0.0, path.keys.front().time, path.keys.back().time, 0.7, 1e12})
      for (const double aspect : {1e-3, 1.0, 1e3}) {
        const CameraView view = evaluate_camera_path(path, time, aspect);
        for (int column = 0; column < 4; ++column)
          for (int row = 0; row < 4; ++row)
            fuzz::require(std::isfinite(view.to_world[column][row]), "a camera is somewhere");
      }
  } catch (const Error&) {
    // Refused, with a reason.
  }
  return 0;
}
