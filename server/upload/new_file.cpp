// SPDX-License-Identifier: MIT
#include "upload/new_file.hpp"

#include <fcntl.h>

#include <cerrno>
#include <cstring>

#include "core/quote.hpp"
#include "util/problem.hpp"

namespace sheaf::server {

NewFile::NewFile(const std::filesystem::path& folder, const std::filesystem::path& relative)
    : name_(relative.string()) {
  const std::filesystem::path path = folder / relative;
  std::error_code error;
  std::filesystem::create_directories(path.parent_path(), error);
  if (!error) fd_ = Fd(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0600));
  if (fd_.valid()) return;
  const int reason = error ? error.value() : errno;
  // The folder holds only what this client sent: a clash is one of its own names.
  if (reason == EEXIST || reason == ENOTDIR || reason == EISDIR)
    throw Problem(ProblemKind::bad_scene, "file name '" + quote(name_) + "': is given twice");
  throw io_error(quote(name_), std::strerror(reason));
}

void NewFile::write(std::string_view bytes) {
  bytes_ += bytes.size();
  while (!bytes.empty()) {
    const ssize_t n = ::write(fd_.get(), bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw io_error(quote(name_), std::strerror(errno));
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
}

void NewFile::close() {
  if (::close(fd_.release()) != 0) throw io_error(quote(name_), std::strerror(errno));
}

}  // namespace sheaf::server
