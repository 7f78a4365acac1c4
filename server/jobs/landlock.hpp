// SPDX-License-Identifier: MIT
// Landlock (Linux 5.13 and later): restricts which files a process may read and write from now on. The kernel's
// interface is declared in landlock.cpp, because the distributions' headers are older than the kernels they may run on.
#pragma once

#include <cstdint>
#include <string>

#include "util/fd.hpp"

namespace sheaf::server {

class FileRules {
 public:
  FileRules();
  [[nodiscard]] bool available() const { return ruleset_.valid(); }

  /// The file, or the folder and everything below it; one that does not exist is ignored.
  void allow_reading(const std::string& path);
  void allow_writing(const std::string& path);

  [[nodiscard]] Fd take() { return std::move(ruleset_); }

  /// For this process and its children, for good. Async-signal-safe; requires no_new_privs.
  [[nodiscard]] static bool enforce(int ruleset) noexcept;

 private:
  void allow(const std::string& path, std::uint64_t access);

  Fd ruleset_;
  std::uint64_t handled_ = 0;
};

}  // namespace sheaf::server
