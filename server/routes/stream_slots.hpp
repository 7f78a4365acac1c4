// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <memory>
#include <string>

#include "util/problem.hpp"

namespace sheaf::server {

/// How many clients may hold a thread each while they wait for events.
class StreamSlots {
 public:
  explicit StreamSlots(std::size_t limit) : limit_(limit) {}

  /// Held until the last copy is gone. Throws Problem (503) if there is none left.
  [[nodiscard]] std::shared_ptr<void> take() {
    if (++used_ > limit_) {
      --used_;
      throw Problem(ProblemKind::too_many_streams, std::to_string(limit_) + " clients are waiting for events")
          .header("Retry-After", "5")
          .passed("max-streams", limit_, limit_ + 1);
    }
    return {this, [this](void*) { --used_; }};
  }
  [[nodiscard]] std::size_t used() const { return used_; }

 private:
  std::size_t limit_;
  std::atomic<std::size_t> used_{0};
};

}  // namespace sheaf::server
