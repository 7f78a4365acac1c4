// SPDX-License-Identifier: MIT
#include "routes/readiness.hpp"

#include <exception>

namespace sheaf::server {
namespace {

constexpr auto retry_after = std::chrono::minutes(1);
constexpr auto grace = std::chrono::seconds(2);
constexpr auto longest = std::chrono::seconds(60);  // a driver that hangs counts as no device
constexpr std::size_t max_reason = 500;

}  // namespace

DeviceProbe::DeviceProbe(std::string sheaf, ConfinementOptions confinement, const std::atomic<std::uint64_t>& losses)
    : sheaf_(std::move(sheaf)), confinement_(std::move(confinement)), losses_(losses), thread_([this] { watch(); }) {}

DeviceProbe::~DeviceProbe() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  stop_.force();
  changed_.notify_all();
  thread_.join();
}

DeviceProbe::Result DeviceProbe::result() {
  const std::lock_guard lock(mutex_);
  if (result_.ready && losses_ != losses_seen_) {
    result_ = {false, "a worker had no device, or lost it: devices are still being looked for"};
    recheck_ = true;
    changed_.notify_all();
  }
  return result_;
}

void DeviceProbe::watch() {
  std::unique_lock lock(mutex_);
  while (!closed_) {
    recheck_ = false;
    losses_seen_ = losses_;
    lock.unlock();
    Result found = probe();
    lock.lock();
    result_ = std::move(found);
    const auto asked = [this] { return closed_ || recheck_; };
    if (result_.ready)
      changed_.wait(lock, asked);
    else
      changed_.wait_for(lock, retry_after, asked);
  }
}

DeviceProbe::Result DeviceProbe::probe() {
  try {
    std::string complaint;
    const WorkerOutput output{[](std::string_view) {},
                              [&](std::string_view bytes) {
                                if (complaint.size() < max_reason) complaint.append(bytes.substr(0, max_reason));
                              }};
    const Confinement confinement(confinement_, sheaf_, {});
    const WorkerEnding ending =
        run_worker({sheaf_, "devices", "--json"}, output, stop_, {grace, longest, &confinement});
    if (ending.exit_code == 0) return {true, ""};
    const std::string line = complaint.substr(0, complaint.find('\n'));
    return {false, line.empty() ? "'sheaf devices' failed" : line};
  } catch (const std::exception& error) {
    return {false, error.what()};
  }
}

}  // namespace sheaf::server
