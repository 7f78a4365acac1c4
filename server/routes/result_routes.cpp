// SPDX-License-Identifier: MIT
#include <fcntl.h>

#include <charconv>

#include "core/quote.hpp"
#include "core/sha256.hpp"
#include "routes/file_reply.hpp"
#include "routes/routes.hpp"
#include "routes/stats_table.hpp"
#include "routes/zip_stream.hpp"
#include "util/fd.hpp"
#include "util/problem.hpp"

namespace sheaf::server {
namespace {

constexpr std::uint64_t max_stats_bytes = std::uint64_t{256} << 20;

const Frame& rendered_frame(const Job& job, const std::string& text) {
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool valid = error == std::errc{} && end == text.data() + text.size();
  const Frame* const frame = valid ? find_frame(job.frames, number) : nullptr;
  if (frame && frame->exr) return *frame;
  const bool may_come = !is_finished(job.state) && (frame || (valid && !job.frames_known));
  if (may_come)
    throw Problem(ProblemKind::not_rendered,
                  "frame " + quote(text) + " is not rendered yet; the job is " + std::string(name_of(job.state)))
        .header("Retry-After", "1");
  if (frame) throw Problem(ProblemKind::not_produced, "the job ended without frame " + quote(text));
  throw Problem(ProblemKind::unknown_frame, "the job has no frame '" + quote(text) + "'");
}

Reply frame_exr(RouteContext& context, Request& request) {
  request.allow_arguments({});
  const Job job = context.service.get(request.parameters["id"]);
  const StoredFile& file = *rendered_frame(job, request.parameters["frame"]).exr;
  return file_reply(request, context.service.files().frames(job.id) / file.name, file, "image/x-exr");
}

Reply frame_png(RouteContext& context, Request& request) {
  request.allow_arguments({});
  const Job job = context.service.get(request.parameters["id"]);
  const Frame& frame = rendered_frame(job, request.parameters["frame"]);
  if (!frame.png) throw Problem(ProblemKind::not_produced, "frame " + std::to_string(frame.number) + " has no preview");
  return file_reply(request, context.service.files().frames(job.id) / frame.png->name, *frame.png, "image/png");
}

[[noreturn]] void not_there(const Job& job, const std::string& what) {
  if (!is_finished(job.state))
    throw Problem(ProblemKind::not_finished, what + " not there yet; the job is " + std::string(name_of(job.state)))
        .header("Retry-After", "1");
  throw Problem(ProblemKind::not_produced, "the job ended without it: " + what + " not there");
}

/// All frames of a finished job.
Reply archive(RouteContext& context, Request& request) {
  request.allow_arguments({});
  const Job job = context.service.get(request.parameters["id"]);
  if (!is_finished(job.state) || job.frames_done == 0) not_there(job, "frames.zip is");

  std::vector<ZipEntry> entries;
  Sha256 identity;
  for (const Frame& frame : job.frames) {
    if (!frame.exr) continue;
    entries.push_back({frame.exr->name, frame.exr->bytes, frame.exr->crc32});
    identity.update(frame.exr->name + '\0' + frame.exr->sha256 + '\n');
  }
  const std::string etag = etag_of(identity.finish());
  if (client_has(request, etag)) return not_modified(etag);

  auto zip = std::make_shared<ZipStream>(entries);
  const auto content = [folder = context.service.files().frames(job.id), entries](std::size_t i, const Writer& write) {
    const Fd fd(::open((folder / entries[i].name).c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
    return fd.valid() && send_file(fd.get(), 0, entries[i].bytes, write);
  };
  Reply reply;
  reply.content_type = "application/zip";
  reply.header("ETag", etag)
      .header("Accept-Ranges", "none")
      .header("Cache-Control", "private, no-cache")
      .header("Content-Disposition", "attachment; filename=\"" + job.id + ".zip\"");
  reply.stream = StreamBody{zip->length(), [zip, content](const Writer& write) { return zip->write(write, content); }};
  return reply;
}

Reply stats_json(RouteContext& context, Request& request) {
  request.allow_arguments({});
  const Job job = context.service.get(request.parameters["id"]);
  const auto path = context.service.files().stats(job.id);
  const std::optional<StoredFile> file = stored_file(path);
  if (!file) not_there(job, "stats are");
  return file_reply(request, path, *file, "application/json");
}

Reply stats_table(RouteContext& context, Request& request) {
  request.allow_arguments({});
  const Job job = context.service.get(request.parameters["id"]);
  const auto path = context.service.files().stats(job.id);
  if (!std::filesystem::exists(path)) not_there(job, "stats are");
  return text_reply("text/csv; charset=utf-8", stats_csv(read_text(path, max_stats_bytes)));
}

Reply worker_log(RouteContext& context, Request& request) {
  request.allow_arguments({});
  const Job job = context.service.get(request.parameters["id"]);
  const auto path = context.service.files().log(job.id);
  const std::uint64_t limit = 2 * context.service.options().runner.log_bytes;  // the notice that it was cut included
  return text_reply("text/plain; charset=utf-8", std::filesystem::exists(path) ? read_text(path, limit) : "");
}

}  // namespace

void add_result_routes(Router& router, RouteContext& context) {
  const auto get = [&](const std::string& pattern, Reply (*handler)(RouteContext&, Request&)) {
    router.add("GET", "/v1/jobs/{id}/" + pattern,
               [&context, handler](Request& request) { return handler(context, request); });
  };
  get("frames/{frame}.exr", frame_exr);
  get("frames/{frame}.png", frame_png);
  get("frames.zip", archive);
  get("stats", stats_json);
  get("stats.json", stats_json);
  get("stats.csv", stats_table);
  get("log", worker_log);
}

}  // namespace sheaf::server
