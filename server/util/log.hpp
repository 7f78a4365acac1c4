// SPDX-License-Identifier: MIT
// The service's log: one JSON object per line on stderr; lines of several threads are never mixed.
#pragma once

#include <nlohmann/json.hpp>
#include <string_view>

namespace sheaf::server {

enum class LogLevel { info, warning, error };

/// `fields` are added to `time`, `level` and `message`.
void write_log(LogLevel level, std::string_view message, const nlohmann::json& fields = nlohmann::json::object());

/// JSON text of strings that may not be valid UTF-8: invalid bytes become U+FFFD.
[[nodiscard]] std::string dump_json(const nlohmann::json& value, int indent = -1);

}  // namespace sheaf::server
