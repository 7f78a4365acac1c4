// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <string>

namespace sheaf::server {

using WallTime = std::chrono::system_clock::time_point;

/// RFC 3339 in UTC with milliseconds: 2025-01-31T12:00:00.000Z.
[[nodiscard]] std::string rfc3339(WallTime time);

}  // namespace sheaf::server
