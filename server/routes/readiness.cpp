// SPDX-License-Identifier: MIT
#include "routes/readiness.hpp"

#include <exception>

namespace sheaf::server {
namespace {

constexpr auto retry_after = std::chrono::minutes(1);
constexpr auto grace = std::chrono::seconds(2);
constexpr auto longest = std::chrono::seconds(60);  // a driver that hangs is none
constexpr std::size_t max_reason = 500;

}  // namespace

DeviceProbe::DeviceProbe(std::string sheaf) : sheaf_(std::move(sheaf)), thread_([this] { watch(); }) {}

DeviceProbe::~DeviceProbe() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  stop_.force();
  changed_.notify_all();
  thread_.join();
}

DeviceProbe::Result DeviceProbe::result() const {
  const std::lock_guard lock(mutex_);
  return result_;
}

void DeviceProbe::watch() {
  std::unique_lock lock(mutex_);
  while (!closed_) {
    lock.unlock();
    Result found = probe();
    lock.lock();
    result_ = std::move(found);
    if (result_.ready) return;
    changed_.wait_for(lock, retry_after, [this] { return closed_; });
  }
}

DeviceProbe::Result DeviceProbe::probe() {
  try {
    std::string complaint;
    const WorkerOutput output{[](std::string_view) {},
                              [&](std::string_view bytes) {
                                if (complaint.size() < max_reason) complaint.append(bytes.substr(0, max_reason));
                              }};
    const WorkerEnding ending = run_worker({sheaf_, "devices", "--json"}, output, stop_, {grace, longest, nullptr});
    if (ending.exit_code == 0) return {true, ""};
    const std::string line = complaint.substr(0, complaint.find('\n'));
    return {false, line.empty() ? "'sheaf devices' failed" : line};
  } catch (const std::exception& error) {
    return {false, error.what()};
  }
}

}  // namespace sheaf::server
