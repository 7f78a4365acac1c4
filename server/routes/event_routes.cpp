// SPDX-License-Identifier: MIT
#include <charconv>

#include "http/problem.hpp"
#include "routes/routes.hpp"

namespace sheaf::server {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t batch_size = 256;
constexpr double max_wait_s = 60;

/// Where to go on: ?after=, else what a reconnecting event source says it has.
std::uint64_t start_after(const Request& request) {
  const auto argument = request.argument("after");
  const std::string text = argument ? *argument : request.header("Last-Event-ID").value_or("0");
  std::uint64_t id = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), id);
  if (error != std::errc{} || end != text.data() + text.size())
    throw Problem(ProblemKind::malformed_request,
                  std::string(argument ? "query: after" : "Last-Event-ID") + " must be an event's id");
  return id;
}

double wait_seconds(const std::string& text) {
  double seconds = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seconds);
  if (error != std::errc{} || end != text.data() + text.size() || !(seconds >= 0))
    throw Problem(ProblemKind::malformed_request, "query: wait must be a number of seconds");
  return std::min(seconds, max_wait_s);
}

nlohmann::ordered_json data_of(const Event& event) {
  nlohmann::ordered_json data = event.data;
  data["time"] = rfc3339(event.time);
  return data;
}

std::string as_sse(const Event& event) {
  return "id: " + std::to_string(event.id) + "\nevent: " + event.type +
         "\ndata: " + data_of(event).dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n\n";
}

/// Sends events until the job's last; false once the client is gone.
bool stream_events(const EventLog& log, std::uint64_t after, std::chrono::milliseconds heartbeat, const Writer& write) {
  if (!write("retry: 2000\n\n")) return false;
  while (true) {
    const EventLog::Batch batch = log.wait(after, batch_size, Clock::now() + heartbeat);
    std::string text;
    for (const Event& event : batch.events) text += as_sse(event);
    if (!batch.events.empty()) after = batch.events.back().id;
    const bool over = batch.ended || log.interrupted();
    if (text.empty() && !over) text = ": keep-alive\n\n";
    if (!text.empty() && !write(text)) return false;
    if (over) return true;
  }
}

Reply long_poll(RouteContext& context, const EventLog& log, std::uint64_t after, double seconds) {
  const std::shared_ptr<void> slot = seconds > 0 ? context.streams.take() : nullptr;
  const auto deadline =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  const EventLog::Batch batch = log.wait(after, batch_size, deadline);
  nlohmann::ordered_json events = nlohmann::ordered_json::array();
  for (const Event& event : batch.events) {
    events.push_back({{"id", event.id}, {"event", event.type}, {"data", data_of(event)}});
    after = event.id;
  }
  return json_reply(200, {{"events", std::move(events)}, {"last", after}, {"ended", batch.ended}});
}

Reply events(RouteContext& context, Request& request) {
  request.allow_arguments({"wait", "after"});
  const std::shared_ptr<EventLog> log = context.service.events(request.parameters["id"]);
  const std::uint64_t after = start_after(request);
  if (const auto wait = request.argument("wait")) return long_poll(context, *log, after, wait_seconds(*wait));

  Reply reply;
  if (log->read(after, 1).ended && log->read(after, 1).events.empty()) {
    reply.status = 204;  // tells an event source not to come back
    return reply;
  }
  const std::shared_ptr<void> slot = context.streams.take();
  reply.content_type = "text/event-stream";
  reply.header("X-Accel-Buffering", "no");  // proxies pass events on at once
  reply.stream = StreamBody{std::nullopt, [log, slot, after, heartbeat = context.heartbeat](const Writer& write) {
                              return stream_events(*log, after, heartbeat, write);
                            }};
  return reply;
}

}  // namespace

void add_event_routes(Router& router, RouteContext& context) {
  router.add("GET", "/v1/jobs/{id}/events", [&context](Request& request) { return events(context, request); });
}

}  // namespace sheaf::server
