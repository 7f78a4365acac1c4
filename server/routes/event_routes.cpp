// SPDX-License-Identifier: MIT
#include <charconv>

#include "routes/routes.hpp"
#include "util/log.hpp"
#include "util/problem.hpp"

namespace sheaf::server {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t batch_size = 256;
constexpr double max_wait_s = 60;

std::uint64_t event_id(const std::string& text, const std::string& what) {
  std::uint64_t id = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), id);
  if (error != std::errc{} || end != text.data() + text.size())
    throw Problem(ProblemKind::malformed_request, what + " must be an event's id");
  return id;
}

/// Where to continue: ?after=, else the last event that a reconnecting event source has. An empty header is ignored.
std::uint64_t start_after(const Request& request) {
  const std::string header = request.header("Last-Event-ID").value_or("");
  const std::uint64_t seen = header.empty() ? 0 : event_id(header, "Last-Event-ID");
  const auto argument = request.argument("after");
  return argument ? event_id(*argument, "query: after") : seen;
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

nlohmann::ordered_json page_of(const EventLog::Batch& batch, std::uint64_t after) {
  nlohmann::ordered_json events = nlohmann::ordered_json::array();
  for (const Event& event : batch.events) {
    events.push_back({{"id", event.id}, {"event", event.type}, {"data", data_of(event)}});
    after = event.id;
  }
  return {{"events", std::move(events)}, {"last", after}, {"ended", batch.ended}};
}

/// The state of a waiting client: the event log, its position, its stream slot.
struct Watcher {
  std::shared_ptr<EventLog> log;
  std::shared_ptr<void> slot;
  std::uint64_t after = 0;
  std::chrono::milliseconds heartbeat;
  Clock::time_point due;
  bool begun = false;

  /// Server-sent events until the job's last.
  bool stream(std::string& out) {
    if (!begun) out += "retry: 2000\n\n";
    begun = true;
    const EventLog::Batch batch = log->read(after, batch_size);
    for (const Event& event : batch.events) out += as_sse(event);
    if (!batch.events.empty()) after = batch.events.back().id;
    if (batch.ended || log->interrupted()) return false;
    if (out.empty() && Clock::now() < due) return true;
    if (out.empty()) out = ": keep-alive\n\n";
    due = Clock::now() + heartbeat;
    return true;
  }

  /// One page, as soon as there is an event or the wait has ended.
  bool poll(std::string& out) {
    const EventLog::Batch batch = log->read(after, batch_size);
    if (batch.events.empty() && !batch.ended && !log->interrupted() && Clock::now() < due) return true;
    out = dump_json(page_of(batch, after)) + "\n";
    return false;
  }
};

LastingBody lasting(const std::shared_ptr<Watcher>& watcher, bool (Watcher::*advance)(std::string&)) {
  return {[watcher, advance](std::string& out) { return (*watcher.*advance)(out); }, [watcher] { return watcher->due; },
          [watcher](std::function<void()> wake) { return watcher->log->watch(std::move(wake)); }};
}

Reply long_poll(RouteContext& context, const std::shared_ptr<EventLog>& log, std::uint64_t after, double seconds) {
  const EventLog::Batch batch = log->read(after, batch_size);
  if (!batch.events.empty() || batch.ended || seconds == 0) return json_reply(200, page_of(batch, after));
  const auto wait = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  auto watcher = std::make_shared<Watcher>();
  *watcher = {log, context.streams.take(), after, context.heartbeat, Clock::now() + wait, false};
  Reply reply;
  reply.content_type = "application/json";
  reply.lasting = lasting(watcher, &Watcher::poll);
  return reply;
}

Reply events(RouteContext& context, Request& request) {
  request.allow_arguments({"wait", "after"});
  const std::shared_ptr<EventLog> log = context.service.events(request.parameters["id"]);
  const std::uint64_t after = start_after(request);
  if (const auto wait = request.argument("wait")) return long_poll(context, log, after, wait_seconds(*wait));

  Reply reply;
  if (log->read(after, 1).ended && log->read(after, 1).events.empty()) {
    reply.status = 204;  // an event source does not reconnect after 204
    return reply;
  }
  auto watcher = std::make_shared<Watcher>();
  *watcher = {log, context.streams.take(), after, context.heartbeat, Clock::now() + context.heartbeat, false};
  reply.content_type = "text/event-stream";
  reply.header("X-Accel-Buffering", "no");  // proxies pass events on at once
  reply.lasting = lasting(watcher, &Watcher::stream);
  return reply;
}

}  // namespace

void add_event_routes(Router& router, RouteContext& context) {
  router.add("GET", "/v1/jobs/{id}/events", [&context](Request& request) { return events(context, request); });
}

}  // namespace sheaf::server
