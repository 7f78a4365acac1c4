// SPDX-License-Identifier: MIT
#include "service.hpp"

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "jobs/memory_job_store.hpp"
#include "routes/routes.hpp"
#include "util/log.hpp"

namespace sheaf::server {
namespace {

/// The data folder: the one named, or one of our own that goes with us.
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
  write_log(LogLevel::info, "request",
            {{"request", exchange.id},
             {"method", exchange.method},
             {"path", exchange.path},
             {"status", exchange.status},
             {"ms", exchange.seconds.count() * 1000}});
}

}  // namespace

struct Service::Parts {
  explicit Parts(const ProgramOptions& given)
      : options(given),
        folder(given.data),
        files(folder.path()),
        jobs(given.service, store, files),
        streams(given.streams),
        device(given.service.runner.sheaf),
        context{jobs, streams, metrics, device, [this] { return http.connections(); }, given.heartbeat},
        http(
            given.http, [this](Request& request) { return handle(router, request); },
            [this](const ExchangeRecord& exchange) {
              metrics.count(exchange);
              write_access_log(exchange);
            }) {
    add_job_routes(router, context);
    add_event_routes(router, context);
    add_result_routes(router, context);
    add_service_routes(router, context);
  }

  ProgramOptions options;
  DataFolder folder;
  MemoryJobStore store;
  JobFiles files;
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

std::string Service::bind() { return parts_->http.bind(parts_->options.host, parts_->options.port); }

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
