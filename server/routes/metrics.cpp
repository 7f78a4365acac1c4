// SPDX-License-Identifier: MIT
#include "routes/metrics.hpp"

#include <algorithm>
#include <limits>
#include <sstream>

namespace sheaf::server {
namespace {

class Text {
 public:
  // With the default of six digits, large sums would not appear to grow.
  Text() { out_.precision(std::numeric_limits<double>::digits10); }
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
  void histogram(const std::string& labels, const Histogram& histogram) {
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < histogram.counts.size(); ++i) {
      sum += histogram.counts[i];
      std::ostringstream bound;
      if (i < Histogram::bounds.size())
        bound << Histogram::bounds[i];
      else
        bound << "+Inf";
      sample(labels + (labels.empty() ? "" : ",") + "le=\"" + bound.str() + "\"", sum, "_bucket");
    }
    sample(labels, histogram.sum, "_sum");
    sample(labels, sum, "_count");
  }
  [[nodiscard]] std::string str() const { return out_.str(); }

 private:
  std::ostringstream out_;
  std::string name_;
};

/// A label's value, escaped.
std::string quoted(const std::string& value) {
  std::string out = "\"";
  for (const char c : value) out += c == '\\' ? "\\\\" : c == '"' ? "\\\"" : c == '\n' ? "\\n" : std::string(1, c);
  return out + "\"";
}

double queue_age(const JobService& service) {
  const std::string id = service.queue().next();
  const std::optional<Job> job = id.empty() ? std::nullopt : service.store().find(id);
  if (!job) return 0;
  return std::max(0.0, std::chrono::duration<double>(std::chrono::system_clock::now() - job->created).count());
}

void write_work(Text& text, const WorkTotals::Sums& work) {
  text.family("stage_seconds", "histogram", "Device time of each stage of a frame; \"frame\": wall time of all.");
  for (const auto& [stage, times] : work.stages) text.histogram("stage=" + quoted(stage), times);
  text.family("rays_total", "counter", "Rays traced since the start, by kind.");
  for (const auto& [kind, count] : work.rays) text.sample("kind=" + quoted(kind), count);
  text.family("tests_total", "counter", "Intersection tests since the start, by kind of test and of ray.");
  for (const auto& [key, count] : work.tests)
    text.sample("test=" + quoted(key.first) + ",kind=" + quoted(key.second), count);
  text.single("device_memory_peak_mib", "gauge", "Most device memory that a frame has taken since the start.",
              work.peak_device_mib);
  if (work.device.empty()) return;
  text.family("device_info", "gauge", "The device of the last job.");
  text.sample("name=" + quoted(work.device) + ",driver=" + quoted(work.driver), 1);
}

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
  text.single("worker_starts_total", "counter", "Workers started since the start.", counters.worker_starts.load());
  text.single("worker_retries_total", "counter", "Workers that were started again after an end from outside.",
              counters.workers_tried_again.load());
  text.single("workers_without_device_total", "counter", "Workers that had no usable device, or lost it.",
              counters.devices_missed.load());
  text.single("queue_age_seconds", "gauge", "How long ago the next job was submitted; 0 if none waits.",
              queue_age(service));
  text.single("queue_waiting", "gauge", "Jobs that wait for a worker.", service.queue().waiting());
  text.single("workers", "gauge", "Workers that may run at once.", service.queue().at_once());
  text.single("disk_free_bytes", "gauge", "Free bytes on the data folder's disk.", service.files().free_bytes());
}

}  // namespace

void Metrics::count(const ExchangeRecord& exchange) {
  const double seconds = exchange.seconds.count();
  const std::lock_guard lock(mutex_);
  // Clients must not be able to create any number of series.
  static constexpr std::array known{"GET", "HEAD", "POST", "DELETE", "OPTIONS"};
  const bool usual = std::ranges::find(known, exchange.method) != known.end();
  ++requests_[{usual ? exchange.method : "other", exchange.status}];
  if (!exchange.refusal.empty()) ++refusals_[exchange.refusal];
  times_.add(seconds);
}

std::string Metrics::text(const JobService& service, const Now& now) const {
  Text text;
  text.family("build_info", "gauge", "The service's version.");
  text.sample("version=\"" SHEAF_VERSION "\"", 1);
  text.single("uptime_seconds", "gauge", "Seconds since the start.",
              std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count());
  write_jobs(text, service);
  text.single("event_streams", "gauge", "Clients that wait for events.", now.streams);
  text.single("connections", "gauge", "Open connections.", now.connections);
  text.single("device_ready", "gauge", "Whether a usable device was found.", now.device_ready ? 1 : 0);
  text.family("worker_confinement", "gauge", "Measures that keep workers from all but their job: 1 where it holds.");
  for (const std::string& measure : all_measures())
    text.sample("measure=" + quoted(measure), std::ranges::count(now.confinement, measure));
  write_work(text, service.counters().work.sums());

  const std::lock_guard lock(mutex_);
  text.family("http_requests_total", "counter", "Requests answered, by method and status.");
  for (const auto& [key, count] : requests_)
    text.sample("method=\"" + key.first + "\",status=\"" + std::to_string(key.second) + "\"", count);
  text.family("http_request_seconds", "histogram", "Time from a request's head to its reply's end.");
  text.histogram("", times_);
  text.family("rejects_total", "counter", "Refusals, by reason: the problem's slug.");
  for (const auto& [slug, count] : refusals_) text.sample("reason=" + quoted(slug), count);
  return text.str();
}

}  // namespace sheaf::server
