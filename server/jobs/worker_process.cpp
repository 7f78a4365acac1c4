// SPDX-License-Identifier: MIT
#include "jobs/worker_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <thread>

#include "core/error.hpp"
#include "jobs/worker_spawn.hpp"

namespace sheaf::server {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t max_line = 64 * 1024;
constexpr auto reap_interval = std::chrono::milliseconds(100);  // while the pipes stay open after the exit
constexpr auto drain_time = std::chrono::milliseconds(500);     // for output that is still in the pipes then

struct Pipe {
  Fd read, write;
};

Pipe make_pipe() {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw io_error("pipe", std::strerror(errno));
  Pipe pipe{Fd(ends[0]), Fd(ends[1])};
  ::fcntl(pipe.read.get(), F_SETFL, O_NONBLOCK);  // the worker's end stays blocking
  return pipe;
}

class Worker {
 public:
  Worker(const std::vector<std::string>& command, const WorkerOutput& output, const StopSwitch& stop,
         const WorkerLimits& limits)
      : output_(output), stop_(stop), limits_(limits), deadline_(Clock::now() + limits.wall) {
    Pipe out = make_pipe(), err = make_pipe();
    pid_ = spawn_worker(command, out.write, err.write, limits.confinement);
    out_ = std::move(out.read);
    err_ = std::move(err.read);
  }
  ~Worker() {
    if (reaped_) return;
    ::kill(-pid_, SIGKILL);
    while (::waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  WorkerEnding run() {
    while (!exited()) {
      apply_stop_request();
      wait_for_output(Clock::now() + reap_interval);
    }
    // The leader is not reaped yet, so its process group's id cannot belong to anybody else.
    ::kill(-pid_, SIGKILL);
    const WorkerEnding ending = reap();
    for (const auto end = Clock::now() + drain_time; (out_.valid() || err_.valid()) && Clock::now() < end;)
      wait_for_output(end);
    if (!line_.empty()) output_.line(line_);
    return ending;
  }

 private:
  [[nodiscard]] bool exited() const {
    siginfo_t info{};
    return ::waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 && info.si_pid == pid_;
  }

  WorkerEnding reap() {
    int status = 0;
    while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
    reaped_ = true;
    if (WIFSIGNALED(status)) return {std::nullopt, WTERMSIG(status), timed_out_};
    return {WEXITSTATUS(status), std::nullopt, timed_out_};
  }

  void apply_stop_request() {
    const bool overdue = limits_.wall.count() > 0 && Clock::now() >= deadline_;
    if ((stop_.asked() || overdue) && !stopping_) {
      timed_out_ = !stop_.asked();
      if (!stop_.forced()) ::kill(-pid_, SIGTERM);
      stopping_ = Clock::now();
    }
    if (!stopping_) return;
    const auto grace = stop_.cancelled() ? std::min(limits_.cancel_grace, limits_.grace) : limits_.grace;
    if (stop_.forced() || Clock::now() >= *stopping_ + grace) ::kill(-pid_, SIGKILL);
  }

  void wait_for_output(Clock::time_point until) {
    const bool watch_stop = !reaped_ && !stop_.forced() && !(stopping_ && stop_.asked());
    std::array<pollfd, 3> entries{pollfd{out_.get(), POLLIN, 0}, pollfd{err_.get(), POLLIN, 0},
                                  pollfd{watch_stop ? stop_.fd() : -1, POLLIN, 0}};
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now()).count();
    // With both pipes closed only the exit is awaited, which mostly follows at once.
    const bool soon = !out_.valid() && !err_.valid() && ++waits_for_exit_ < 20;
    const long long most = soon ? std::min<long long>(left, 5) : left;
    if (::poll(entries.data(), entries.size(), static_cast<int>(std::max<long long>(most, 0))) <= 0) return;
    if (entries[0].revents) drain(out_, [this](std::string_view bytes) { take_lines(bytes); });
    if (entries[1].revents) drain(err_, output_.log);
  }

  /// One block, so that a worker that floods one pipe does not keep the other or the stop switch waiting.
  template <typename Take>
  static void drain(Fd& fd, const Take& take) {
    std::array<char, 64 * 1024> block;
    const ssize_t n = ::read(fd.get(), block.data(), block.size());
    if (n > 0)
      take(std::string_view(block.data(), static_cast<std::size_t>(n)));
    else if (n == 0 || (errno != EAGAIN && errno != EINTR))
      fd.reset();
  }

  void take_lines(std::string_view bytes) {
    while (!bytes.empty()) {
      const auto end = bytes.find('\n');
      line_.append(bytes.substr(0, end));
      bytes.remove_prefix(end == std::string_view::npos ? bytes.size() : end + 1);
      if (end == std::string_view::npos && line_.size() < max_line) return;
      output_.line(line_);
      line_.clear();
    }
  }

  const WorkerOutput& output_;
  const StopSwitch& stop_;
  const WorkerLimits& limits_;
  Clock::time_point deadline_;
  bool timed_out_ = false;
  pid_t pid_ = 0;
  bool reaped_ = false;
  int waits_for_exit_ = 0;
  Fd out_, err_;
  std::string line_;
  std::optional<Clock::time_point> stopping_;  // since when
};

}  // namespace

StopSwitch::StopSwitch() : event_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (!event_.valid()) throw io_error("eventfd", std::strerror(errno));
}

void StopSwitch::raise_to(int level) {
  for (int now = level_; now < level && !level_.compare_exchange_weak(now, level);) {
  }
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t n = ::write(event_.get(), &one, sizeof one);
}

void StopSwitch::ask() { raise_to(1); }
void StopSwitch::cancel() { raise_to(2); }
void StopSwitch::force() { raise_to(3); }

WorkerEnding run_worker(const std::vector<std::string>& command, const WorkerOutput& output, const StopSwitch& stop,
                        const WorkerLimits& limits) {
  return Worker(command, output, stop, limits).run();
}

std::string signal_name(int number) {
  const char* const name = ::sigabbrev_np(number);
  return name ? std::string("SIG") + name : "signal " + std::to_string(number);
}

}  // namespace sheaf::server
