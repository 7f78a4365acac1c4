// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace sheaf::server {

/// A worker's stats.json as the engine's own CSV: one line per frame. Throws Error{input} for text that is no such
/// file.
[[nodiscard]] std::string stats_csv(const std::string& json);

}  // namespace sheaf::server
