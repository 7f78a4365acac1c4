// SPDX-License-Identifier: MIT
#include "store/job_record.hpp"

#include "core/error.hpp"

namespace sheaf::server {
namespace {

using Json = nlohmann::ordered_json;

Json time_to_json(const std::optional<WallTime>& time) { return time ? Json(to_milliseconds(*time)) : Json(nullptr); }

std::optional<WallTime> time_from_json(const Json& json) {
  if (json.is_null()) return std::nullopt;
  return from_milliseconds(json.get<std::int64_t>());
}

template <typename Value>
Json to_json(const std::optional<Value>& value) {
  return value ? Json(*value) : Json(nullptr);
}

template <typename Value>
std::optional<Value> from_json(const Json& json) {
  if (json.is_null()) return std::nullopt;
  return json.get<Value>();
}

Json error_to_json(const std::optional<Failure>& error) {
  if (!error) return nullptr;
  return {{"code", error->code},
          {"title", error->title},
          {"message", error->message},
          {"exit_code", to_json(error->exit_code)},
          {"signal", to_json(error->signal)}};
}

std::optional<Failure> error_from_json(const Json& json) {
  if (json.is_null()) return std::nullopt;
  return Failure{json.at("code").get<std::string>(), json.at("title").get<std::string>(),
                 json.at("message").get<std::string>(), from_json<int>(json.at("exit_code")),
                 from_json<int>(json.at("signal"))};
}

void read_summary(const Json& json, JobSummary& job) {
  job.cancel_requested = json.at("cancel_requested").get<bool>();
  job.created = from_milliseconds(json.at("created").get<std::int64_t>());
  job.started = time_from_json(json.at("started"));
  job.finished = time_from_json(json.at("finished"));
  job.expires = time_from_json(json.at("expires"));
  job.starts = json.at("starts").get<std::uint64_t>();
  job.fruitless_starts = json.at("fruitless_starts").get<std::uint64_t>();
  job.scene_bytes = json.at("scene_bytes").get<std::uint64_t>();
  job.has_camera = json.at("has_camera").get<bool>();
  job.settings = json.at("settings");
  job.total = from_json<std::uint64_t>(json.at("total"));
  job.frames_done = json.at("frames_done").get<std::uint64_t>();
  job.error = error_from_json(json.at("error"));
}

template <typename Read>
void parse(const std::string& record, const Read& read) {
  try {
    read(Json::parse(record));
  } catch (const Json::exception& error) {
    throw io_error("database", std::string("a job's record is damaged: ") + error.what());
  }
}

}  // namespace

std::int64_t to_milliseconds(WallTime time) {
  return std::chrono::duration_cast<std::chrono::milliseconds>(time.time_since_epoch()).count();
}

WallTime from_milliseconds(std::int64_t milliseconds) { return WallTime(std::chrono::milliseconds(milliseconds)); }

std::string to_record(const Job& job) {
  const Json json{{"cancel_requested", job.cancel_requested},
                  {"created", to_milliseconds(job.created)},
                  {"started", time_to_json(job.started)},
                  {"finished", time_to_json(job.finished)},
                  {"expires", time_to_json(job.expires)},
                  {"starts", job.starts},
                  {"fruitless_starts", job.fruitless_starts},
                  {"scene_bytes", job.scene_bytes},
                  {"has_camera", job.has_camera},
                  {"settings", job.settings},
                  {"total", to_json(job.total)},
                  {"frames_done", job.frames_done},
                  {"error", error_to_json(job.error)},
                  {"arguments", job.arguments},
                  {"frames_known", job.frames_known}};
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

void from_record(const std::string& record, JobSummary& job) {
  parse(record, [&](const Json& json) { read_summary(json, job); });
}

void from_record(const std::string& record, Job& job) {
  parse(record, [&](const Json& json) {
    read_summary(json, job);
    job.arguments = json.at("arguments").get<std::vector<std::string>>();
    job.frames_known = json.at("frames_known").get<bool>();
  });
}

}  // namespace sheaf::server
