// SPDX-License-Identifier: MIT
#include "program/service.hpp"

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "routes/routes.hpp"
#include "store/sqlite_job_store.hpp"
#include "util/log.hpp"

namespace sheaf::server {
namespace {

constexpr const char* database_name = "jobs.db";

/// The data folder: the one named, or a temporary one that is removed at the end.
class DataFolder {
 public:
  explicit DataFolder(const std::string& named) : path_(named), own_(named.empty()) {
    if (!own_) return;
    std::string pattern = (std::filesystem::temp_directory_path() / "sheafd-XXXXXX").string();
    if (!::mkdtemp(pattern.data())) throw io_error(pattern, std::strerror(errno));
    path_ = pattern;
  }
  ~DataFolder() {
    std::error_code ignored;
    if (own_) std::filesystem::remove_all(path_, ignored);
  }
  DataFolder(const DataFolder&) = delete;
  DataFolder& operator=(const DataFolder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  bool own_;
};

void write_access_log(const ExchangeRecord& exchange) {
  nlohmann::json fields{{"request", exchange.id},
                        {"method", exchange.method},
                        {"path", exchange.path},
                        {"status", exchange.status},
                        {"ms", exchange.seconds.count() * 1000}};
  if (!exchange.job.empty()) fields["job"] = exchange.job;
  if (!exchange.client.empty()) fields["client"] = exchange.client;
  if (!exchange.refusal.empty()) fields["refusal"] = exchange.refusal;
  write_log(LogLevel::info, "request", fields);
}

}  // namespace

struct Service::Parts {
  explicit Parts(const ProgramOptions& given)
      : options(given),
        tokens(given.token_file),
        folder(given.data),
        files(folder.path()),
        fresh(!std::filesystem::exists(files.data() / database_name)),
        store((files.data() / database_name).string()),
        jobs(given.service, store, files),
        streams(given.streams),
        device(given.service.runner.sheaf, given.service.runner.confinement, jobs.counters().devices_missed),
        context{jobs,
                streams,
                metrics,
                device,
                [this] { return http.connections(); },
                active_measures(given.service.runner.confinement),
                given.heartbeat,
                given.report},
        http(
            given.http, [this](Request& request) { return handle(router, tokens, request); },
            [this](const ExchangeRecord& exchange) {
              metrics.count(exchange);
              write_access_log(exchange);
            }) {
    write_log(LogLevel::info, "worker confinement", {{"active", context.confinement}, {"known", all_measures()}});
    jobs.recover(fresh);
    add_job_routes(router, context);
    add_event_routes(router, context);
    add_result_routes(router, context);
    add_service_routes(router, context);
  }

  ProgramOptions options;
  Tokens tokens;
  DataFolder folder;
  JobFiles files;  // holds the folder's lock, so no other service has the database open
  bool fresh;
  SqliteJobStore store;
  JobService jobs;
  StreamSlots streams;
  Metrics metrics;
  DeviceProbe device;
  RouteContext context;
  Router router;
  HttpServer http;
};

Service::Service(const ProgramOptions& options) : parts_(std::make_unique<Parts>(options)) {}
Service::~Service() = default;

std::string Service::bind() {
  const ProgramOptions& options = parts_->options;
  const std::string address = parts_->http.bind(options.host, options.port);
  const bool local = address.starts_with("127.") || address.starts_with("[::1]") || address.starts_with("[::ffff:127.");
  if (!local && !parts_->tokens.required() && !options.anonymous)
    throw Error(ErrorKind::usage,
                "--listen " + address +
                    " is open to other machines: give a --token-file, or --allow-anonymous if whoever "
                    "can connect may submit jobs");
  return address;
}

void Service::run() {
  parts_->http.run();
  parts_->jobs.shut_down();
}

void Service::stop() {
  parts_->jobs.shut_down();
  parts_->http.stop();
}

std::vector<std::string> Service::routes() const { return parts_->router.routes(); }

}  // namespace sheaf::server
