// SPDX-License-Identifier: MIT
// The settings part of a submission: those of the engine's table that HTTP takes, checked here so that a mistake is
// answered at once, and turned into the worker's arguments. Nothing that names a path on this machine is accepted.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "jobs/limits.hpp"

namespace sheaf::server {

struct Settings {
  nlohmann::ordered_json resolved;                  // as the worker is told, with the service's own defaults
  std::vector<std::string> arguments;               // "--size=640x360"
  std::optional<std::vector<std::int64_t>> frames;  // where the client named them, in order
};

/// `has_camera`: a camera path was uploaded. Throws Problem: 422 naming the key and the reason.
[[nodiscard]] Settings parse_settings(const nlohmann::json& given, bool has_camera, const Limits& limits);

}  // namespace sheaf::server
