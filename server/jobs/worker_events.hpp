// SPDX-License-Identifier: MIT
// The lines a worker prints with --progress json. A worker is not trusted: lines that are not
// well-formed events are ignored.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

namespace sheaf::server {

struct StartEvent {
  std::uint64_t frames = 0;
};
struct FrameEvent {
  std::int64_t frame = 0;
  double wall_ms = 0;
  std::optional<double> eta_s;
  std::string file;  // the file's name alone, whatever folder the worker gave
};
struct WarningEvent {
  std::string message;
};
struct ErrorEvent {
  std::string message;
};
struct DoneEvent {};

using WorkerEvent = std::variant<StartEvent, FrameEvent, WarningEvent, ErrorEvent, DoneEvent>;

[[nodiscard]] std::optional<WorkerEvent> parse_worker_event(std::string_view line);

}  // namespace sheaf::server
