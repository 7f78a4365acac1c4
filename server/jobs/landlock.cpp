// SPDX-License-Identifier: MIT
#include "jobs/landlock.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace sheaf::server {
namespace {

// uapi/linux/landlock.h; the same on every architecture, and so are the numbers of the calls.
constexpr long create_ruleset = 444, add_rule = 445, restrict_self = 446;
constexpr unsigned version_flag = 1;
constexpr int path_beneath = 1;

struct RulesetAttributes {
  std::uint64_t files, network, scoped;
};
struct __attribute__((packed)) PathBeneath {
  std::uint64_t allowed;
  std::int32_t parent;
};

constexpr std::uint64_t execute = 1, write_file = 2, read_file = 4, read_folder = 8;
constexpr std::uint64_t refer = 1 << 13, truncate = 1 << 14;
constexpr std::uint64_t of_files = execute | write_file | read_file | truncate;
constexpr std::uint64_t to_read = execute | read_file | read_folder;

/// All accesses to files that this version knows, except control of devices (bit 15), which drivers need.
std::uint64_t accesses_of(long version) {
  std::uint64_t accesses = (1 << 13) - 1;
  if (version >= 2) accesses |= refer;
  if (version >= 3) accesses |= truncate;
  return accesses;
}

}  // namespace

FileRules::FileRules() {
  const long version = ::syscall(create_ruleset, nullptr, 0, version_flag);
  if (version < 1) return;
  handled_ = accesses_of(version);
  // TCP from version 4 on; abstract Unix sockets and signals to others from version 6 on. None is allowed again.
  const RulesetAttributes attributes{handled_, 3, 3};
  const std::size_t size = version >= 6 ? 24 : version >= 4 ? 16 : 8;
  ruleset_ = Fd(static_cast<int>(::syscall(create_ruleset, &attributes, size, 0)));
}

void FileRules::allow(const std::string& path, std::uint64_t access) {
  const Fd fd(::open(path.c_str(), O_PATH | O_CLOEXEC));
  struct stat info {};
  if (!fd.valid() || ::fstat(fd.get(), &info) != 0) return;
  if (!S_ISDIR(info.st_mode)) access &= of_files;
  const PathBeneath rule{access & handled_, fd.get()};
  ::syscall(add_rule, ruleset_.get(), path_beneath, &rule, 0);
}

void FileRules::allow_reading(const std::string& path) { allow(path, to_read); }
void FileRules::allow_writing(const std::string& path) { allow(path, ~std::uint64_t{0}); }

bool FileRules::enforce(int ruleset) noexcept { return ::syscall(restrict_self, ruleset, 0) == 0; }

}  // namespace sheaf::server
