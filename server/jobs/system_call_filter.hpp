// SPDX-License-Identifier: MIT
#pragma once

#include <linux/filter.h>

#include <vector>

namespace sheaf::server {

/// The system calls of a worker (seccomp): no sockets, no new namespaces, and none of the calls that only debuggers,
/// administrators and exploits use. libseccomp allocates, so it is used only to make the program, before any fork.
class SystemCallFilter {
 public:
  /// Does nothing later where libseccomp does not know this architecture.
  SystemCallFilter();

  /// For this process and its children, for good. Async-signal-safe; requires no_new_privs. False where it cannot be
  /// done.
  [[nodiscard]] bool install() const noexcept;

 private:
  std::vector<sock_filter> program_;
};

}  // namespace sheaf::server
