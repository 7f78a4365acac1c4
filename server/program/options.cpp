// SPDX-License-Identifier: MIT
#include "program/options.hpp"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>

#include "core/error.hpp"

namespace sheaf::server {
namespace {

/// The engine installed beside this program, else the one in the PATH.
std::string default_worker() {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  if (error) return "sheaf";
  for (const auto& beside : {self.parent_path() / "sheaf", self.parent_path().parent_path() / "engine" / "sheaf"})
    if (::access(beside.c_str(), X_OK) == 0 && std::filesystem::is_regular_file(beside, error)) return beside.string();
  return "sheaf";
}

/// Limits in the units of the command line.
struct Given {
  std::string listen = "127.0.0.1:8080";
  std::uint64_t upload_mib = Limits{}.upload_bytes >> 20, unpacked_mib = Limits{}.unpacked_bytes >> 20;
  std::uint64_t textures_mib = Limits{}.texture_bytes >> 20;
  std::uint64_t log_kib = Limits{}.log_bytes >> 10, free_mib = 256, kept_mib = 0;
  std::uint64_t worker_mib = 16'384, file_mib = 8192, wall_s = 7 * 86'400;
  double grace_s = 5, cancel_grace_s = 0.5, retention_h = 168, heartbeat_s = 15, read_timeout_s = 30,
         head_timeout_s = 10;
};

void add_limits(CLI::App& app, Given& given, ProgramOptions& options) {
  Limits& limits = options.service.limits;
  const auto limit = [&](const char* name, auto& value, const char* what) {
    app.add_option(name, value, what)->capture_default_str()->check(CLI::PositiveNumber)->group("Limits");
  };
  limit("--max-upload", given.upload_mib, "MiB of a whole request");
  limit("--max-unpacked", given.unpacked_mib, "MiB out of a .zip");
  limit("--max-zip-entries", limits.zip_entries, "entries of a .zip");
  limit("--max-zip-ratio", limits.zip_ratio, "unpacked to packed size");
  limit("--max-parts", limits.parts, "parts of a multipart body");
  limit("--max-frames", limits.frames, "frames of a job");
  limit("--max-inspect", limits.inspect_seconds, "seconds for loading a scene once, before its job is accepted");
  app.add_option("--max-triangles", limits.triangles, "triangles of a scene, instances counted; 0: any")
      ->capture_default_str()
      ->group("Limits");
  app.add_option("--max-textures", given.textures_mib, "MiB of a scene's decoded images; 0: any")
      ->capture_default_str()
      ->group("Limits");
  limit("--max-pixels", limits.pixels, "pixels of a frame");
  limit("--max-spp", limits.spp, "samples per pixel");
  limit("--max-depth", limits.depth, "depth of reflection and refraction");
  limit("--max-memory", limits.memory_mib, "MiB of a job's memory budget");
  limit("--max-queue", limits.queued_jobs, "jobs that wait");
  limit("--max-log", given.log_kib, "KiB kept of a worker's log");
  limit("--max-connections", options.http.max_connections, "open connections");
  limit("--max-streams", options.streams, "clients that wait for events");
  limit("--http-threads", options.http.pool.threads, "threads that answer requests");
  limit("--max-stalled", options.http.pool.max_stalled,
        "slow clients that may hold an additional thread each; beyond, the slowest is cut off");
  limit("--worker-memory", given.worker_mib, "MiB of private memory of a worker");
  limit("--max-cpu", options.service.runner.confinement.cpu_seconds, "seconds of processor time of a worker");
  limit("--max-wall", given.wall_s, "seconds that a worker may run");
  limit("--max-file", given.file_mib, "MiB of one file that a worker writes");
  app.add_option("--min-free", given.free_mib, "MiB of free disk below which no job is accepted")
      ->capture_default_str()
      ->group("Limits");
}

std::chrono::milliseconds milliseconds(double seconds) {
  return std::chrono::milliseconds(static_cast<std::int64_t>(seconds * 1000));
}

void apply(const Given& given, ProgramOptions& options) {
  Limits& limits = options.service.limits;
  limits.upload_bytes = given.upload_mib << 20;
  limits.unpacked_bytes = given.unpacked_mib << 20;
  limits.inspect_seconds = std::min(limits.inspect_seconds, given.wall_s);
  limits.texture_bytes = given.textures_mib << 20;
  limits.log_bytes = given.log_kib << 10;
  options.http.max_body = limits.upload_bytes;
  options.http.timeouts.read = milliseconds(given.read_timeout_s);
  options.http.timeouts.write = milliseconds(given.read_timeout_s);
  options.http.timeouts.head = milliseconds(given.head_timeout_s);
  options.service.max_submissions = std::max<std::size_t>(1, options.http.pool.threads / 2);
  options.heartbeat = milliseconds(given.heartbeat_s);
  options.service.min_free_bytes = given.free_mib << 20;
  RunnerOptions& runner = options.service.runner;
  runner.confinement.memory_bytes = given.worker_mib << 20;
  runner.confinement.file_bytes = given.file_mib << 20;
  runner.wall = std::chrono::seconds(given.wall_s);
  options.service.kept_bytes = given.kept_mib << 20;
  options.service.runner.log_bytes = limits.log_bytes;
  options.service.runner.grace = milliseconds(given.grace_s);
  options.service.runner.cancel_grace = milliseconds(given.cancel_grace_s);
  options.service.runner.retention = std::chrono::seconds(
      given.retention_h > 0 ? std::max<std::int64_t>(1, std::llround(given.retention_h * 3600)) : 0);
  split_address(given.listen, options.host, options.port);
}

}  // namespace

void split_address(const std::string& text, std::string& host, std::string& port) {
  const auto colon = text.rfind(':');
  const bool bracketed = text.starts_with('[');
  if (colon == std::string::npos || (bracketed && (colon < 2 || text[colon - 1] != ']')))
    throw Error(ErrorKind::usage, "--listen '" + text + "': must be HOST:PORT");
  host = bracketed ? text.substr(1, colon - 2) : text.substr(0, colon);
  port = text.substr(colon + 1);
  const bool digits =
      !port.empty() && port.size() <= 5 && std::ranges::all_of(port, [](char c) { return c >= '0' && c <= '9'; });
  if (!digits || std::stoi(port) > 65535)
    throw Error(ErrorKind::usage, "--listen '" + text + "': the port is not 0 to 65535");
}

ProgramOptions parse_options(int argc, const char* const* argv, std::string& help) {
  ProgramOptions options;
  Given given;
  options.service.runner.sheaf = default_worker();
  CLI::App app("Renders glTF animations sent over HTTP, each job in a sheaf process of its own.", "sheafd");
  app.set_version_flag("--version", "sheafd " SHEAF_VERSION);
  app.add_option("--listen", given.listen, "HOST:PORT; port 0: any free one")->capture_default_str()->take_last();
  app.add_option("--data", options.data,
                 "folder for jobs and their files; default: a temporary one, removed at the end");
  app.add_option("--sheaf", options.service.runner.sheaf, "the worker's program")->capture_default_str();
  app.add_option("--jobs", options.service.jobs_at_once, "workers at once")
      ->capture_default_str()
      ->check(CLI::Range(1, 256));
  app.add_option("--port-file", options.port_file, "file that receives the bound address once the service listens");
  app.add_option("--token-file", options.token_file,
                 "who may use the service: lines \"NAME read,submit sha256:HEX\"; needed beyond loopback");
  app.add_flag("--allow-anonymous", options.anonymous, "listen beyond loopback without a token file");
  app.add_option("--new-token", options.new_token,
                 "NAME=SCOPES: print the token file's line for a new token, and the token on stderr, and exit");
  app.add_option("--report", options.report, "report.json of sheaf-client report, shown on the page");
  app.add_option("--retention", given.retention_h, "hours for which a finished job is kept; 0: for ever")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber);
  app.add_option("--max-kept", given.kept_mib,
                 "MiB of all jobs; above it, the jobs that ended first are removed; 0: any")
      ->capture_default_str()
      ->group("Limits");
  app.add_flag("!--no-confinement", options.service.runner.confinement.on,
               "let workers read and do whatever the service may (limits still hold)");
  app.add_option("--worker-reads", options.service.runner.confinement.readable,
                 "further folder that workers may read, as for drivers in unusual places; may be repeated");
  app.add_option("--worker-nice", options.service.runner.confinement.nice,
                 "niceness of workers beyond the service's own, so that it answers while they render")
      ->capture_default_str()
      ->check(CLI::Range(0, 19));
  app.add_option("--attempts", options.service.runner.attempts,
                 "starts of a job's worker without a new frame, if a lost device or a kill from outside ended it")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  app.add_option("--grace", given.grace_s, "seconds from SIGTERM to SIGKILL when a worker is stopped")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber);
  app.add_option("--cancel-grace", given.cancel_grace_s,
                 "the same for a cancelled job, which ends within a second; at most --grace")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber);
  app.add_option("--heartbeat", given.heartbeat_s, "seconds between comments on an idle event stream")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  app.add_option("--io-timeout", given.read_timeout_s, "seconds a client may pause while it sends or receives a body")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  app.add_option("--head-timeout", given.head_timeout_s, "seconds for a request's head")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  add_limits(app, given, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0) throw Error(ErrorKind::usage, error.what());
    std::ostringstream out, ignored;
    app.exit(error, out, ignored);
    help = out.str();
    return options;
  }
  apply(given, options);
  return options;
}

}  // namespace sheaf::server
