// SPDX-License-Identifier: MIT
#include "jobs/worker_log.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>

#include "core/error.hpp"

namespace sheaf::server {
namespace {

constexpr std::size_t max_line = 8192;
constexpr std::string_view cut_notice = "… the rest of the log is left out\n";

void write_all(const Fd& file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(file.get(), bytes.data(), bytes.size());
    if (n <= 0) return;  // a full disk costs log lines, not the job
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
}

}  // namespace

WorkerLog::WorkerLog(const std::filesystem::path& path, std::uint64_t limit, std::string hidden)
    : file_(::open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600)),
      left_(limit),
      hidden_(std::move(hidden)) {
  const off_t there = file_.valid() ? ::lseek(file_.get(), 0, SEEK_END) : 0;  // of an earlier worker
  left_ -= std::min(left_, static_cast<std::uint64_t>(std::max<off_t>(there, 0)));
}

void WorkerLog::end() {
  if (!partial_.empty()) line(partial_);
  partial_.clear();
}

std::string WorkerLog::without_paths(std::string_view text) const {
  std::string out(text);
  for (auto at = out.find(hidden_); !hidden_.empty() && at != std::string::npos; at = out.find(hidden_, at)) {
    std::size_t length = hidden_.size();
    while (at + length < out.size() && out[at + length] == '/') ++length;
    out.erase(at, length);
  }
  return out;
}

void WorkerLog::append(std::string_view bytes) {
  while (!bytes.empty()) {
    const auto end = bytes.find('\n');
    partial_.append(bytes.substr(0, end));
    bytes.remove_prefix(end == std::string_view::npos ? bytes.size() : end + 1);
    if (end == std::string_view::npos && partial_.size() < max_line) return;
    const std::string whole = std::move(partial_);
    partial_.clear();
    line(whole);
  }
}

void WorkerLog::line(std::string_view text) {
  const std::string clean = without_paths(text) + "\n";
  if (clean.size() > 1) last_ = clean.substr(0, std::min<std::size_t>(clean.size() - 1, 1000));
  if (left_ == 0) return;
  if (clean.size() > left_) {
    left_ = 0;
    write_all(file_, cut_notice);
    return;
  }
  left_ -= clean.size();
  write_all(file_, clean);
}

}  // namespace sheaf::server
