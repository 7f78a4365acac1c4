// SPDX-License-Identifier: MIT
// Push constants: raster.
#ifndef SHEAF_PUSH_RASTER_H
#define SHEAF_PUSH_RASTER_H
#include "interface/push/push.h"
SHEAF_INTERFACE_BEGIN

// raster_spans
struct RasterSpansPush {
  DeviceAddress shown;  // the visibility buffer: by address its words are loaded in half the time
  uint bands;  // of rows, so that few triangles keep all cores busy
};
SHEAF_PUSH(RasterSpansPush, 3)

SHEAF_INTERFACE_END
#endif
