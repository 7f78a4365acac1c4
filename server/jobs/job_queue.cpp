// SPDX-License-Identifier: MIT
#include "jobs/job_queue.hpp"

namespace sheaf::server {

JobQueue::JobQueue(const JobRunner& runner, std::size_t at_once, std::function<void(const std::string& id)> ended)
    : runner_(runner), ended_(std::move(ended)) {
  for (std::size_t i = 0; i < at_once; ++i) threads_.emplace_back([this] { work(); });
}

JobQueue::~JobQueue() { shut_down(); }

void JobQueue::add(const std::string& id) {
  {
    const std::lock_guard lock(mutex_);
    waiting_.push_back(id);
  }
  ready_.notify_one();
}

void JobQueue::forget(const std::string& id) {
  const std::lock_guard lock(mutex_);
  std::erase(waiting_, id);
}

void JobQueue::stop_worker(const std::string& id, bool force) {
  const std::lock_guard lock(mutex_);
  const auto found = running_.find(id);
  if (found == running_.end()) return;
  if (force)
    found->second->force();
  else
    found->second->cancel();
}

bool JobQueue::is_running(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  return running_.contains(id);
}

std::size_t JobQueue::waiting() const {
  const std::lock_guard lock(mutex_);
  return waiting_.size();
}

std::string JobQueue::next() const {
  const std::lock_guard lock(mutex_);
  return waiting_.empty() ? "" : waiting_.front();
}

void JobQueue::shut_down() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    waiting_.clear();
    for (const auto& [id, stop] : running_) stop->ask();
  }
  ready_.notify_all();
  for (std::thread& thread : threads_)
    if (thread.joinable()) thread.join();
}

void JobQueue::work() {
  while (true) {
    std::string id;
    auto stop = std::make_shared<StopSwitch>();
    {
      std::unique_lock lock(mutex_);
      ready_.wait(lock, [this] { return closed_ || !waiting_.empty(); });
      if (closed_) return;
      id = std::move(waiting_.front());
      waiting_.pop_front();
      running_[id] = stop;  // before the job's state says so: who sees it running can stop it
    }
    runner_.run(id, *stop);
    {
      const std::lock_guard lock(mutex_);
      running_.erase(id);
    }
    ended_(id);
  }
}

}  // namespace sheaf::server
