// SPDX-License-Identifier: MIT
#include "output/write_target.hpp"

#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <ctime>
#include <filesystem>
#include <system_error>

#include "core/error.hpp"

namespace sheaf {
namespace {

namespace fs = std::filesystem;

constexpr int max_links = 40;  // as Linux follows

// /proc/PID/fd/N of this process, which /dev/stdout and /dev/fd/N lead to. Opened anew, a regular file there would be
// written from its start, over what the descriptor's owner wrote.
std::optional<int> own_descriptor(const fs::path& path) {
  const std::string folder = path.parent_path().string(), number = path.filename().string();
  if (folder != "/proc/" + std::to_string(getpid()) + "/fd") return std::nullopt;
  int descriptor = -1;
  const char* end = number.data() + number.size();
  const auto [rest, error] = std::from_chars(number.data(), end, descriptor);
  return error == std::errc{} && rest == end ? std::optional(descriptor) : std::nullopt;
}

bool takes_a_stream(const std::string& path) {
  struct stat status {};
  return stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode);
}

// A thread's own SIGPIPE is held back while it writes, and taken off again where the write raised it.
class NoPipeSignal {
 public:
  NoPipeSignal() {
    sigemptyset(&pipe_);
    sigaddset(&pipe_, SIGPIPE);
    sigset_t pending;
    sigpending(&pending);
    was_pending_ = sigismember(&pending, SIGPIPE) == 1;
    pthread_sigmask(SIG_BLOCK, &pipe_, &before_);
  }
  ~NoPipeSignal() {
    const timespec at_once{};
    if (!was_pending_)
      while (sigtimedwait(&pipe_, nullptr, &at_once) < 0 && errno == EINTR) {
      }
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  NoPipeSignal(const NoPipeSignal&) = delete;
  NoPipeSignal& operator=(const NoPipeSignal&) = delete;

 private:
  sigset_t pipe_{}, before_{};
  bool was_pending_ = false;
};

int write_all(int descriptor, std::span<const std::byte> bytes) {
  const NoPipeSignal quiet;
  while (!bytes.empty()) {
    const ssize_t written = write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return 0;
}

}  // namespace

WriteTarget find_write_target(const std::string& path) {
  fs::path at = path;
  std::error_code error;
  for (int links = 0; links <= max_links; ++links) {
    const fs::path folder = fs::canonical(at.has_parent_path() ? at.parent_path() : fs::path("."), error);
    if (error || !at.has_filename()) return {at.string(), takes_a_stream(path), {}};
    if (const auto descriptor = own_descriptor(folder / at.filename())) return {path, true, descriptor};
    if (!fs::is_symlink(fs::symlink_status(at, error))) return {at.string(), takes_a_stream(at.string()), {}};
    const fs::path link = fs::read_symlink(at, error);
    if (error) break;
    at = folder / link;  // which is `link` where that is absolute
  }
  throw io_error(path, "cannot be followed: " + (error ? error.message() : "too many symbolic links"));
}

int write_to_stream(const WriteTarget& target, std::span<const std::byte> bytes) {
  const int descriptor = target.descriptor ? fcntl(*target.descriptor, F_DUPFD_CLOEXEC, 0)
                                           : open(target.path.c_str(), O_WRONLY | O_NOCTTY | O_CLOEXEC);
  if (descriptor < 0) return errno;
  const int failed = write_all(descriptor, bytes);
  const bool closed = close(descriptor) == 0;
  return failed != 0 ? failed : closed ? 0 : errno;
}

}  // namespace sheaf
