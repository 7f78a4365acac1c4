// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <memory>
#include <string>

#include "util/problem.hpp"

namespace sheaf::server {

/// Bounds how many clients wait for events (--max-streams).
class StreamSlots {
 public:
  explicit StreamSlots(std::size_t limit) : limit_(limit) {}

  /// A slot, held until the last copy is destroyed. Throws Problem (503) if none is free.
  [[nodiscard]] std::shared_ptr<void> take() {
    if (++used_ > limit_) {
      --used_;
      throw Problem(ProblemKind::too_many_streams, std::to_string(limit_) + " clients are waiting for events")
          .header("Retry-After", "5")
          .exceeded("max-streams", limit_, limit_ + 1);
    }
    return {this, [this](void*) { --used_; }};
  }
  [[nodiscard]] std::size_t used() const { return used_; }

 private:
  std::size_t limit_;
  std::atomic<std::size_t> used_{0};
};

}  // namespace sheaf::server
