// SPDX-License-Identifier: MIT
// Compact (R 4.4): slots that hold a ray become a list without gaps, in slot order.
#pragma once

#include "device_data/ray_lists.hpp"
#include "interface/push/push.h"
#include "stages/scan.hpp"

namespace sheaf {

class Compact {
 public:
  explicit Compact(const Device& device) : scan_(device, "compact") {}
  void record(Recorder& recorder, const RayList& list, std::uint32_t kind) const {
    recorder.stage("compact");
    list.bind(recorder);
    scan_.record(recorder, gpu::KindPush{kind}, kind == gpu::KIND_SHADOW ? gpu::ARGS_SLOTS_SHADOW : gpu::ARGS_SLOTS);
  }
  /// A list whose number of slots the host knows.
  void record_all(Recorder& recorder, const RayList& list, std::uint32_t kind, std::uint32_t slots) const {
    recorder.stage("compact");
    list.bind(recorder);
    scan_.record_blocks(recorder, gpu::KindPush{kind}, (slots + gpu::SCAN_BLOCK - 1) / gpu::SCAN_BLOCK);
  }

 private:
  Scan scan_;
};

}  // namespace sheaf
