// SPDX-License-Identifier: MIT
// Landlock (Linux 5.13 and later): which files a process may read and write from now on, whatever its user may. The
// kernel's interface is spelled out here, because the headers that distributions have know less than their kernels.
#pragma once

#include <cstdint>
#include <string>

#include "util/fd.hpp"

namespace sheaf::server {

class FileRules {
 public:
  FileRules();
  [[nodiscard]] bool available() const { return ruleset_.valid(); }

  /// The file, or the folder and all below; nothing happens if it is not there.
  void allow_reading(const std::string& path);
  void allow_writing(const std::string& path);

  [[nodiscard]] Fd take() { return std::move(ruleset_); }

  /// For this process and its children, for good. Async-signal-safe; wants no_new_privs.
  [[nodiscard]] static bool enforce(int ruleset) noexcept;

 private:
  void allow(const std::string& path, std::uint64_t access);

  Fd ruleset_;
  std::uint64_t handled_ = 0;
};

}  // namespace sheaf::server
