// SPDX-License-Identifier: MIT
#include "jobs/worker_events.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

namespace sheaf::server {
namespace {

using nlohmann::json;

std::optional<std::string> text(const json& event, const char* key) {
  const auto found = event.find(key);
  if (found == event.end() || !found->is_string()) return std::nullopt;
  return found->get<std::string>();
}

std::optional<double> seconds(const json& event, const char* key) {
  const auto found = event.find(key);
  if (found == event.end() || !found->is_number()) return std::nullopt;
  const double value = found->get<double>();
  if (!std::isfinite(value) || value < 0) return std::nullopt;
  return value;
}

std::optional<WorkerEvent> frame_event(const json& event) {
  const auto number = event.find("frame");
  const std::optional<std::string> file = text(event, "file");
  if (number == event.end() || !number->is_number_integer() || !file) return std::nullopt;
  const std::string name = file->substr(file->rfind('/') + 1);
  if (name.empty() || name == "." || name == ".." || name.find('\0') != std::string::npos) return std::nullopt;
  return FrameEvent{number->get<std::int64_t>(), seconds(event, "wall_ms").value_or(0), seconds(event, "eta_s"), name};
}

}  // namespace

std::optional<WorkerEvent> parse_worker_event(std::string_view line) {
  const json event = json::parse(line, nullptr, false);
  if (!event.is_object()) return std::nullopt;
  const std::optional<std::string> type = text(event, "event");
  if (type == "start") {
    const auto frames = event.find("frames");
    if (frames == event.end() || !frames->is_number_unsigned()) return std::nullopt;
    return StartEvent{frames->get<std::uint64_t>()};
  }
  if (type == "frame") return frame_event(event);
  if (type == "warning") return WarningEvent{text(event, "message").value_or("")};
  if (type == "error") return ErrorEvent{text(event, "message").value_or("")};
  if (type == "done") return DoneEvent{};
  return std::nullopt;
}

}  // namespace sheaf::server
