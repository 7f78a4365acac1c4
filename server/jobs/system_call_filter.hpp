// SPDX-License-Identifier: MIT
#pragma once

namespace sheaf::server {

/// From now on this process and its children have no sockets, no new namespaces, and none of the system calls that
/// only debuggers, administrators and exploits use (seccomp). Async-signal-safe; wants no_new_privs. False where it
/// cannot be done.
[[nodiscard]] bool install_system_call_filter() noexcept;

}  // namespace sheaf::server
