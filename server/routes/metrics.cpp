// SPDX-License-Identifier: MIT
#include "routes/metrics.hpp"

#include <algorithm>
#include <sstream>

namespace sheaf::server {
namespace {

class Text {
 public:
  void family(const std::string& name, const std::string& type, const std::string& help) {
    name_ = "sheaf_" + name;
    out_ << "# HELP " << name_ << ' ' << help << "\n# TYPE " << name_ << ' ' << type << '\n';
  }
  template <typename Value>
  void sample(const std::string& labels, Value value, const std::string& suffix = "") {
    out_ << name_ << suffix << (labels.empty() ? "" : "{" + labels + "}") << ' ' << value << '\n';
  }
  template <typename Value>
  void single(const std::string& name, const std::string& type, const std::string& help, Value value) {
    family(name, type, help);
    sample("", value);
  }
  [[nodiscard]] std::string str() const { return out_.str(); }

 private:
  std::ostringstream out_;
  std::string name_;
};

void write_jobs(Text& text, const JobService& service) {
  text.family("jobs", "gauge", "Jobs that are kept, by state.");
  for (const auto& [state, count] : service.store().count())
    text.sample("state=\"" + std::string(name_of(state)) + "\"", count);
  const Counters& counters = service.counters();
  text.family("jobs_ended_total", "counter", "Jobs that ended since the start, by state.");
  for (const JobState state : {JobState::done, JobState::failed, JobState::cancelled})
    text.sample("state=\"" + std::string(name_of(state)) + "\"",
                counters.jobs_ended[static_cast<std::size_t>(state)].load());
  text.single("jobs_accepted_total", "counter", "Jobs accepted since the start.", counters.jobs_accepted.load());
  text.single("frames_rendered_total", "counter", "Frames rendered since the start.", counters.frames_rendered.load());
  text.single("queue_waiting", "gauge", "Jobs that wait for a worker.", service.queue().waiting());
  text.single("workers", "gauge", "Workers that may run at once.", service.queue().at_once());
  text.single("disk_free_bytes", "gauge", "Free bytes on the data folder's disk.", service.files().free_bytes());
}

}  // namespace

void Metrics::count(const ExchangeRecord& exchange) {
  const double seconds = exchange.seconds.count();
  const auto bucket = static_cast<std::size_t>(std::ranges::lower_bound(bounds, seconds) - bounds.begin());
  const std::lock_guard lock(mutex_);
  // A stranger must not be able to make series without end.
  static constexpr std::array known{"GET", "HEAD", "POST", "DELETE", "OPTIONS"};
  const bool usual = std::ranges::find(known, exchange.method) != known.end();
  ++requests_[{usual ? exchange.method : "other", exchange.status}];
  ++times_[bucket];
  seconds_ += seconds;
}

std::string Metrics::text(const JobService& service, std::size_t streams, std::size_t connections) const {
  Text text;
  text.family("build_info", "gauge", "The service's version.");
  text.sample("version=\"" SHEAF_VERSION "\"", 1);
  text.single("uptime_seconds", "gauge", "Seconds since the start.",
              std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count());
  write_jobs(text, service);
  text.single("event_streams", "gauge", "Clients that wait for events.", streams);
  text.single("connections", "gauge", "Open connections.", connections);

  const std::lock_guard lock(mutex_);
  text.family("http_requests_total", "counter", "Requests answered, by method and status.");
  for (const auto& [key, count] : requests_)
    text.sample("method=\"" + key.first + "\",status=\"" + std::to_string(key.second) + "\"", count);
  text.family("http_request_seconds", "histogram", "Time from a request's head to its reply's end.");
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < times_.size(); ++i) {
    sum += times_[i];
    std::ostringstream bound;
    if (i < bounds.size())
      bound << bounds[i];
    else
      bound << "+Inf";
    text.sample("le=\"" + bound.str() + "\"", sum, "_bucket");
  }
  text.sample("", seconds_, "_sum");
  text.sample("", sum, "_count");
  return text.str();
}

}  // namespace sheaf::server
