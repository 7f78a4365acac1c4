// SPDX-License-Identifier: MIT
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

#include "util/fd.hpp"

namespace sheaf::server {

class Confinement;

/// Starts `command`: stdin from /dev/null, no descriptor of the service, default signals, a process group of its own,
/// confined unless `confinement` is null, and killed when the thread that started it ends, however that comes about.
/// Throws Error{io} if the program cannot be started.
[[nodiscard]] pid_t spawn_worker(const std::vector<std::string>& command, const Fd& out, const Fd& err,
                                 const Confinement* confinement);

}  // namespace sheaf::server
