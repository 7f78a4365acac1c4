// SPDX-License-Identifier: MIT
#include "jobs/worker_spawn.hpp"

#include <fcntl.h>
#include <linux/close_range.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>

#include "core/error.hpp"
#include "jobs/confinement.hpp"

extern char** environ;

namespace sheaf::server {
namespace {

/// Where a name without a '/' is found. The child must not look for it: only system calls are safe there.
std::string program_of(const std::string& name) {
  if (name.find('/') != std::string::npos) return name;
  const char* const value = std::getenv("PATH");
  const std::string path = value ? value : "/usr/bin:/bin";
  for (std::size_t at = 0; at <= path.size();) {
    const auto end = std::min(path.find(':', at), path.size());
    const std::string place = path.substr(at, end - at) + "/" + name;
    if (::access(place.c_str(), X_OK) == 0) return place;
    at = end + 1;
  }
  return name;
}

struct Child {
  const char* program;
  char* const* arguments;
  int in, out, err, failure;
  pid_t parent;
  const Confinement* confinement;
};

[[noreturn]] void fail(const Child& child) {
  const int reason = errno;
  [[maybe_unused]] const ssize_t n = ::write(child.failure, &reason, sizeof reason);
  ::_exit(127);
}

/// Between fork and exec: system calls alone, since other threads may have held any lock.
[[noreturn]] void become(const Child& child) {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL, 0, 0, 0);
  if (::getppid() != child.parent) ::_exit(127);  // it died before that
  struct sigaction standard {};
  standard.sa_handler = SIG_DFL;
  for (int number = 1; number < NSIG; ++number) ::sigaction(number, &standard, nullptr);
  if (::dup2(child.in, STDIN_FILENO) < 0 || ::dup2(child.out, STDOUT_FILENO) < 0 ||
      ::dup2(child.err, STDERR_FILENO) < 0)
    fail(child);
  ::close_range(3, ~0u, CLOSE_RANGE_CLOEXEC);  // ours are so anyway; libraries' may not be
  if (child.confinement) (void)child.confinement->apply();
  sigset_t none;
  ::sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  ::execve(child.program, child.arguments, environ);
  fail(child);
}

pid_t fork_into(const Child& child) {
  // No handler of ours may run in the child.
  sigset_t all, before;
  ::sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before);
  const pid_t pid = ::fork();
  if (pid == 0) become(child);
  const int reason = errno;
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  errno = reason;
  return pid;
}

}  // namespace

pid_t spawn_worker(const std::vector<std::string>& command, const Fd& out, const Fd& err,
                   const Confinement* confinement) {
  std::vector<char*> arguments;
  for (const std::string& argument : command) arguments.push_back(const_cast<char*>(argument.c_str()));
  arguments.push_back(nullptr);
  const std::string program = program_of(command[0]);
  const Fd in(::open("/dev/null", O_RDONLY | O_CLOEXEC));
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw io_error("pipe", std::strerror(errno));
  const Fd heard(ends[0]);
  Fd said(ends[1]);

  const pid_t pid = fork_into(
      {program.c_str(), arguments.data(), in.get(), out.get(), err.get(), said.get(), ::getpid(), confinement});
  if (pid < 0) throw io_error(command[0], std::string("cannot be started: ") + std::strerror(errno));
  said.reset();
  int reason = 0;
  ssize_t n = 0;
  do {
    n = ::read(heard.get(), &reason, sizeof reason);
  } while (n < 0 && errno == EINTR);
  if (n == 0) {
    ::setpgid(pid, pid);  // it did so itself; nothing happens
    return pid;
  }
  while (::waitpid(pid, nullptr, 0) < 0 && errno == EINTR) {
  }
  throw io_error(command[0], std::string("cannot be started: ") + std::strerror(reason));
}

}  // namespace sheaf::server
