// SPDX-License-Identifier: MIT
#include "jobs/job_files.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <vector>

#include "core/error.hpp"
#include "core/sha256.hpp"
#include "util/ids.hpp"
#include "util/log.hpp"

namespace sheaf::server {
namespace fs = std::filesystem;
namespace {

void make_folder(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) throw io_error(path.string(), error.message());
}

/// O_NOFOLLOW: a worker cannot make the service read elsewhere through a link.
Fd open_regular(const fs::path& path, std::uint64_t& bytes) {
  Fd fd(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
  struct stat info {};
  if (!fd.valid() || ::fstat(fd.get(), &info) != 0 || !S_ISREG(info.st_mode)) return Fd();
  bytes = static_cast<std::uint64_t>(info.st_size);
  return fd;
}

void sync(const fs::path& path, int flags) {
  const Fd fd(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | flags));
  if (!fd.valid() || ::fsync(fd.get()) != 0) throw io_error(path.string(), std::strerror(errno));
}

void sync_tree(const fs::path& folder) {
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
    sync(entry.path(), entry.is_directory() ? O_DIRECTORY : 0);
  sync(folder, O_DIRECTORY);
}

}  // namespace

JobFiles::JobFiles(fs::path data) : data_(fs::absolute(std::move(data))) {
  make_folder(data_);
  const fs::path lock = data_ / "lock";
  lock_ = Fd(::open(lock.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600));
  if (!lock_.valid()) throw io_error(lock.string(), std::strerror(errno));
  // A record lock: forked children do not have it, so that a killed service's lock is gone with it, whatever a child
  // that had not come to its exec yet still holds open.
  struct flock whole {};
  whole.l_type = F_WRLCK;
  if (::fcntl(lock_.get(), F_SETLK, &whole) != 0)
    throw io_error(data_.string(), "another sheafd uses this data folder");
  std::error_code ignored;
  fs::remove_all(data_ / "incoming", ignored);
  make_folder(data_ / "incoming");
  make_folder(data_ / "jobs");
}

fs::path JobFiles::receive(const std::string& id) const {
  const fs::path path = data_ / "incoming" / id;
  make_folder(path / "scene");
  return path;
}

void JobFiles::accept(const std::string& id) const {
  std::error_code error;
  fs::create_directory(data_ / "incoming" / id / "frames", error);
  if (!error) sync_tree(data_ / "incoming" / id);
  if (!error) fs::rename(data_ / "incoming" / id, folder(id), error);
  if (error) throw io_error(folder(id).string(), error.message());
  sync(data_ / "jobs", O_DIRECTORY);
}

void JobFiles::remove_orphan_folders(const std::function<bool(const std::string& id)>& known) const {
  std::vector<std::string> orphans;
  for (const fs::directory_entry& entry : fs::directory_iterator(data_ / "jobs"))
    if (is_id(entry.path().filename().string()) && !known(entry.path().filename().string()))
      orphans.push_back(entry.path().filename().string());
  for (const std::string& id : orphans) remove(id);
}

void JobFiles::remove(const std::string& id) const noexcept {
  for (const char* place : {"incoming", "jobs"}) {
    std::error_code error;
    fs::remove_all(data_ / place / id, error);
    if (error) write_log(LogLevel::warning, "cannot remove a job's files", {{"job", id}, {"reason", error.message()}});
  }
}

std::uint64_t JobFiles::free_bytes() const {
  std::error_code error;
  const fs::space_info space = fs::space(data_, error);
  return error ? 0 : space.available;
}

std::optional<std::string> JobFiles::write_error() const {
  const fs::path path = data_ / "incoming" / ("." + random_id());
  const Fd fd(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600));
  int error = fd.valid() ? 0 : errno;
  if (fd.valid()) {
    constexpr std::array<char, 4096> block{};
    const ssize_t n = ::write(fd.get(), block.data(), block.size());
    if (n != static_cast<ssize_t>(block.size())) error = n < 0 ? errno : ENOSPC;
    ::unlink(path.c_str());
  }
  if (error == 0) return std::nullopt;
  return "the data folder cannot be written: " + std::string(std::strerror(error));
}

std::optional<StoredFile> stored_file(const fs::path& path) {
  StoredFile file;
  file.name = path.filename().string();
  const Fd fd = open_regular(path, file.bytes);
  if (!fd.valid()) return std::nullopt;
  Sha256 hash;
  uLong crc = ::crc32(0, nullptr, 0);
  std::vector<char> block(std::size_t{1} << 18);
  std::uint64_t total = 0;
  for (ssize_t n = 0; (n = ::read(fd.get(), block.data(), block.size())) != 0;) {
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return std::nullopt;
    const auto size = static_cast<std::size_t>(n);
    hash.update({block.data(), size});
    crc = ::crc32(crc, reinterpret_cast<const Bytef*>(block.data()), static_cast<uInt>(size));
    total += size;
  }
  if (total != file.bytes) return std::nullopt;
  file.crc32 = static_cast<std::uint32_t>(crc);
  file.sha256 = hash.finish();
  return file;
}

std::string read_text(const fs::path& path, std::uint64_t limit) {
  std::uint64_t bytes = 0;
  const Fd fd = open_regular(path, bytes);
  if (!fd.valid()) throw io_error(path.filename().string(), "cannot be read");
  if (bytes > limit)
    throw limit_error(path.filename().string(),
                      "has " + std::to_string(bytes) + " bytes, the limit is " + std::to_string(limit));
  std::string text(static_cast<std::size_t>(bytes), '\0');
  std::size_t at = 0;
  for (ssize_t n = 0; at < text.size() && (n = ::read(fd.get(), text.data() + at, text.size() - at)) != 0;) {
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw io_error(path.filename().string(), std::strerror(errno));
    at += static_cast<std::size_t>(n);
  }
  text.resize(at);
  return text;
}

}  // namespace sheaf::server
