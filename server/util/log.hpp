// SPDX-License-Identifier: MIT
// The service's own log: one JSON object a line on stderr, whole lines whatever the threads do.
#pragma once

#include <nlohmann/json.hpp>
#include <string_view>

namespace sheaf::server {

enum class LogLevel { info, warning, error };

/// `fields` join `time`, `level` and `message`.
void write_log(LogLevel level, std::string_view message, const nlohmann::json& fields = nlohmann::json::object());

/// JSON text for bytes that may not be UTF-8: what cannot be shown becomes U+FFFD.
[[nodiscard]] std::string dump_json(const nlohmann::json& value, int indent = -1);

}  // namespace sheaf::server
