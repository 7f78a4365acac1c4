// SPDX-License-Identifier: MIT
#include "util/log.hpp"

#include <unistd.h>

#include <chrono>
#include <mutex>
#include <string>

#include "util/clock.hpp"

namespace sheaf::server {

std::string dump_json(const nlohmann::json& value, int indent) {
  return value.dump(indent, ' ', false, nlohmann::json::error_handler_t::replace);
}

void write_log(LogLevel level, std::string_view message, const nlohmann::json& fields) {
  static std::mutex mutex;
  nlohmann::json entry = fields;
  entry["time"] = rfc3339(std::chrono::system_clock::now());
  entry["level"] = level == LogLevel::info ? "info" : level == LogLevel::warning ? "warning" : "error";
  entry["message"] = message;
  const std::string line = dump_json(entry) + "\n";
  const std::lock_guard lock(mutex);
  for (std::size_t at = 0; at < line.size();) {
    const ssize_t n = ::write(STDERR_FILENO, line.data() + at, line.size() - at);
    if (n <= 0) return;  // a closed stderr must not stop the service
    at += static_cast<std::size_t>(n);
  }
}

}  // namespace sheaf::server
