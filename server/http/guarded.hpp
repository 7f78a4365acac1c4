// SPDX-License-Identifier: MIT
#pragma once

#include <functional>

#include "http/message.hpp"
#include "util/problem.hpp"

namespace sheaf::server {

/// Runs `handler`; what it throws becomes a problem+json reply.
[[nodiscard]] Reply guarded(Request& request, const std::function<Reply(Request&)>& handler);

[[nodiscard]] Reply problem_reply(const Problem& problem, const std::string& instance);

}  // namespace sheaf::server
