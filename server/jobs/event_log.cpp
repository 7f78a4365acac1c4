// SPDX-License-Identifier: MIT
#include "jobs/event_log.hpp"

#include <algorithm>

namespace sheaf::server {

void NewEvents::append(const std::string& type, nlohmann::ordered_json data) {
  events_.push_back({last_ + events_.size() + 1, type, std::move(data), std::chrono::system_clock::now()});
}

void EventLog::publish(const std::vector<Event>& events, bool last) {
  const std::lock_guard lock(mutex_);
  if (closed_) return;
  events_.insert(events_.end(), events.begin(), events.end());
  closed_ = last;
  notify_watchers();
}

void EventLog::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  notify_watchers();
}

void EventLog::interrupt() {
  const std::lock_guard lock(mutex_);
  interrupted_ = true;
  notify_watchers();
}

void EventLog::notify_watchers() const {
  changed_.notify_all();
  for (const auto& [number, wake] : watches_) wake();
}

std::shared_ptr<void> EventLog::watch(std::function<void()> wake) const {
  const std::lock_guard lock(mutex_);
  const std::uint64_t number = ++last_watch_;
  watches_[number] = std::move(wake);
  return {nullptr, [this, number](std::nullptr_t) {  // whoever watches holds the log as well
            const std::lock_guard again(mutex_);
            watches_.erase(number);
          }};
}

std::uint64_t EventLog::size() const {
  const std::lock_guard lock(mutex_);
  return events_.size();
}

bool EventLog::interrupted() const {
  const std::lock_guard lock(mutex_);
  return interrupted_;
}

EventLog::Batch EventLog::read_locked(std::uint64_t after, std::size_t most) const {
  Batch batch;
  const std::size_t first = static_cast<std::size_t>(std::min<std::uint64_t>(after, events_.size()));
  const std::size_t last = first + std::min(events_.size() - first, most);
  batch.events.assign(events_.begin() + static_cast<std::ptrdiff_t>(first),
                      events_.begin() + static_cast<std::ptrdiff_t>(last));
  batch.ended = closed_ && last == events_.size();
  return batch;
}

EventLog::Batch EventLog::read(std::uint64_t after, std::size_t most) const {
  const std::lock_guard lock(mutex_);
  return read_locked(after, most);
}

EventLog::Batch EventLog::wait(std::uint64_t after, std::size_t most,
                               std::chrono::steady_clock::time_point deadline) const {
  std::unique_lock lock(mutex_);
  changed_.wait_until(lock, deadline, [&] { return closed_ || interrupted_ || events_.size() > after; });
  return read_locked(after, most);
}

}  // namespace sheaf::server
