// SPDX-License-Identifier: MIT
// A worker: a program in its own process group whose standard output is read line by line and whose standard error is
// a log. Whatever it does (crash, hang, flood, leave children behind), run_worker() returns in bounded time after a
// stop request, and no process of the group is left.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "util/fd.hpp"

namespace sheaf::server {

/// Tells a running worker to stop. Safe from any thread, before, while and after it runs.
class StopSwitch {
 public:
  StopSwitch();
  void ask();     // SIGTERM, and SIGKILL after the grace period
  void cancel();  // the same with a shorter one: the frame in progress is not wanted
  void force();   // SIGKILL
  [[nodiscard]] bool asked() const { return level_ > 0; }
  [[nodiscard]] bool cancelled() const { return level_ > 1; }
  [[nodiscard]] bool forced() const { return level_ > 2; }
  [[nodiscard]] int fd() const { return event_.get(); }  // readable once the switch was used

 private:
  void raise_to(int level);
  Fd event_;
  std::atomic<int> level_{0};
};

struct WorkerEnding {
  std::optional<int> exit_code, signal;  // one of them
  bool timed_out = false;                // it was stopped because it ran too long
};

struct WorkerOutput {
  std::function<void(std::string_view line)> line;  // of stdout, without its end; a line too long comes in pieces
  std::function<void(std::string_view bytes)> log;  // of stderr
};

class Confinement;

struct WorkerLimits {
  std::chrono::milliseconds grace{5000};        // from SIGTERM to SIGKILL
  std::chrono::seconds wall{0};                 // how long it may run; 0: any time
  const Confinement* confinement = nullptr;     // none
  std::chrono::milliseconds cancel_grace{500};  // from SIGTERM to SIGKILL once it is cancelled, if less than `grace`
};

/// Throws Error{io} if the program cannot be started.
[[nodiscard]] WorkerEnding run_worker(const std::vector<std::string>& command, const WorkerOutput& output,
                                      const StopSwitch& stop, const WorkerLimits& bounds);

/// "SIGSEGV", or "signal 64".
[[nodiscard]] std::string signal_name(int number);

}  // namespace sheaf::server
