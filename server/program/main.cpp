// SPDX-License-Identifier: MIT
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <string>
#include <thread>

#include "access/tokens.hpp"
#include "core/error.hpp"
#include "output/atomic_file.hpp"
#include "program/service.hpp"
#include "util/log.hpp"

namespace {

/// Connections and files are many; the usual soft limit is 1024.
std::size_t raise_file_limit() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return 1024;
  limit.rlim_cur = limit.rlim_max;
  ::setrlimit(RLIMIT_NOFILE, &limit);
  return static_cast<std::size_t>(std::min<rlim_t>(limit.rlim_cur, 1 << 20));
}

int print_token(const std::string& wanted) {
  const sheaf::server::NewToken made = sheaf::server::make_token(wanted);
  std::printf("%s\n", made.line.c_str());
  std::fprintf(stderr, "token, not stored anywhere: %s\n", made.token.c_str());
  return 0;
}

int serve(const sheaf::server::ProgramOptions& options, const sigset_t& stop_signals) {
  using namespace sheaf::server;
  Service service(options);
  const std::string address = service.bind();
  if (!options.port_file.empty()) sheaf::write_file_atomically(options.port_file, address + "\n");
  write_log(LogLevel::info, "listening", {{"address", address}, {"worker", options.service.runner.sheaf}});

  std::thread stopper([&] {
    int signal = 0;
    ::sigwait(&stop_signals, &signal);
    write_log(LogLevel::info, "stopping", {{"signal", signal_name(signal)}});
    service.stop();
  });
  service.run();
  stopper.join();
  write_log(LogLevel::info, "stopped");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  // Blocked before the first thread starts, so that only the thread that waits for them gets them.
  sigset_t stop_signals;
  ::sigemptyset(&stop_signals);
  ::sigaddset(&stop_signals, SIGTERM);
  ::sigaddset(&stop_signals, SIGINT);
  ::pthread_sigmask(SIG_BLOCK, &stop_signals, nullptr);
  ::signal(SIGPIPE, SIG_IGN);
  ::signal(SIGXFSZ, SIG_IGN);  // a limit on files is an error like a full disk
  const std::size_t files = raise_file_limit();
  try {
    std::string help;
    auto options = sheaf::server::parse_options(argc, argv, help);
    // Connections, and beside them the files of replies, uploads, workers and the database.
    options.http.max_connections = std::min(options.http.max_connections, std::max<std::size_t>(64, files * 3 / 4));
    if (!help.empty()) {
      std::fputs(help.c_str(), stdout);
      return 0;
    }
    if (!options.new_token.empty()) return print_token(options.new_token);
    return serve(options, stop_signals);
  } catch (const sheaf::Error& error) {
    std::fprintf(stderr, "sheafd: %s\n", error.what());
    return error.exit_code();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "sheafd: %s\n", error.what());
    return 1;
  }
}
