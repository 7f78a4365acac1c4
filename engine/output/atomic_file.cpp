// SPDX-License-Identifier: MIT
#include "output/atomic_file.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <filesystem>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "core/error.hpp"

namespace sheaf {
namespace {

constexpr std::size_t buffer_bytes = std::size_t{1} << 20;
constexpr int max_attempts = 1000;

std::string reason(int error_number) { return std::generic_category().message(error_number); }

enum class LockState { held, taken_by_other, unsupported };

LockState try_lock(int descriptor) {
  while (flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
    if (errno == EWOULDBLOCK) return LockState::taken_by_other;
    if (errno != EINTR) return LockState::unsupported;
  }
  return LockState::held;
}

// A cleaner may have removed the file between our open and our lock; then the lock is on a file without a name.
bool still_named(int descriptor, const std::string& path) {
  struct stat by_descriptor {
  }, by_name{};
  return fstat(descriptor, &by_descriptor) == 0 && stat(path.c_str(), &by_name) == 0 &&
         by_descriptor.st_dev == by_name.st_dev && by_descriptor.st_ino == by_name.st_ino;
}

// `.NAME.PID.part`, or `.NAME.PID-2.part` where somebody else holds that: process ids repeat across containers.
std::string part_name(const std::filesystem::path& path, int attempt) {
  std::string name = ".";
  name += path.filename().string();
  name += "." + std::to_string(getpid());
  if (attempt > 1) name += "-" + std::to_string(attempt);
  name += ".part";
  return (path.parent_path() / name).string();
}

std::optional<pid_t> writer_of(std::string_view name) {
  constexpr std::string_view ending = ".part";
  if (name.size() < 2 || name.front() != '.' || !name.ends_with(ending)) return std::nullopt;
  name.remove_suffix(ending.size());
  const std::size_t dot = name.rfind('.');
  if (dot == std::string_view::npos || dot < 2) return std::nullopt;
  pid_t pid = 0;
  const char* end = name.data() + name.size();
  const auto [rest, error] = std::from_chars(name.data() + dot + 1, end, pid);
  if (error != std::errc{} || pid <= 0) return std::nullopt;
  if (rest == end) return pid;
  const bool numbered =
      *rest == '-' && rest + 1 != end && std::all_of(rest + 1, end, [](char c) { return c >= '0' && c <= '9'; });
  return numbered ? std::optional(pid) : std::nullopt;
}

bool remove_if_stale(const std::string& path, pid_t writer) {
  const int descriptor = open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return false;
  struct stat status {};
  const bool regular = fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
  bool stale = false;
  if (regular) {
    const LockState lock = try_lock(descriptor);
    const bool writer_gone = kill(writer, 0) != 0 && errno == ESRCH;
    stale = lock == LockState::held || (lock == LockState::unsupported && writer_gone);
  }
  const bool removed = stale && unlink(path.c_str()) == 0;
  close(descriptor);
  return removed;
}

}  // namespace

AtomicFile::AtomicFile(std::string path) : path_(std::move(path)), target_(find_write_target(path_)) {
  if (std::filesystem::path(path_).filename().empty()) fail("cannot create", EISDIR);
  if (!target_.is_stream) create_part();
}

void AtomicFile::create_part() {
  for (int attempt = 1; attempt <= max_attempts; ++attempt) {
    temporary_path_ = part_name(target_.path, attempt);
    const int descriptor = open(temporary_path_.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (descriptor < 0) fail("cannot create", errno);
    if (try_lock(descriptor) != LockState::taken_by_other && still_named(descriptor, temporary_path_)) {
      descriptor_ = descriptor;
      // A dead process of our id may have left something longer.
      if (ftruncate(descriptor_, 0) != 0) fail("cannot create", errno);
      return;
    }
    close(descriptor);
  }
  fail("cannot create", EEXIST);
}

AtomicFile::~AtomicFile() {
  if (descriptor_ < 0) return;
  unlink(temporary_path_.c_str());
  close(descriptor_);
}

void AtomicFile::fail(const std::string& doing, int error_number) {
  failure_ = doing + ": " + reason(error_number);
  if (descriptor_ >= 0) {
    unlink(temporary_path_.c_str());
    close(std::exchange(descriptor_, -1));
  }
  throw io_error(path_, failure_);
}

void AtomicFile::check_writable() const {
  if (!failure_.empty()) throw io_error(path_, failure_);
  if (done_) throw io_error(path_, "already written");
}

void AtomicFile::write(std::span<const std::byte> bytes) {
  check_writable();
  buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
  if (buffer_.size() >= buffer_bytes) flush();
}

void AtomicFile::seek(std::uint64_t position) {
  check_writable();
  flush();
  position_ = position;
}

void AtomicFile::keep() {
  if (kept_.size() < position_ + buffer_.size()) kept_.resize(position_ + buffer_.size());
  std::copy(buffer_.begin(), buffer_.end(), kept_.begin() + static_cast<std::ptrdiff_t>(position_));
  position_ += buffer_.size();
  buffer_.clear();
}

void AtomicFile::flush() {
  if (target_.is_stream) return keep();
  std::size_t done = 0;
  while (done < buffer_.size()) {
    const ssize_t written =
        pwrite(descriptor_, buffer_.data() + done, buffer_.size() - done, static_cast<off_t>(position_ + done));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail("cannot write", errno);
    done += static_cast<std::size_t>(written);
  }
  position_ += done;
  buffer_.clear();
}

void AtomicFile::commit() {
  check_writable();
  flush();
  if (target_.is_stream) {
    if (const int error = write_to_stream(target_, kept_); error != 0) fail("cannot write", error);
    done_ = true;
    return;
  }
  if (fsync(descriptor_) != 0) fail("cannot write", errno);
  if (rename(temporary_path_.c_str(), target_.path.c_str()) != 0) fail("cannot rename into place", errno);
  // Only now, since closing gives up the lock that keeps cleaners away.
  close(std::exchange(descriptor_, -1));
  done_ = true;
}

void write_file_atomically(const std::string& path, std::span<const std::byte> bytes) {
  AtomicFile file(path);
  file.write(bytes);
  file.commit();
}

void write_file_atomically(const std::string& path, const std::string& text) {
  write_file_atomically(path, std::as_bytes(std::span(text)));
}

std::size_t remove_stale_parts(const std::string& directory) {
  std::size_t removed = 0;
  try {
    for (const auto& entry : std::filesystem::directory_iterator(directory.empty() ? "." : directory)) {
      const std::optional<pid_t> writer = writer_of(entry.path().filename().string());
      if (writer && remove_if_stale(entry.path().string(), *writer)) ++removed;
    }
  } catch (const std::filesystem::filesystem_error& error) {
    throw io_error(directory, "cannot read the directory: " + error.code().message());
  }
  return removed;
}

}  // namespace sheaf
