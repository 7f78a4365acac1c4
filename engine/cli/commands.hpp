// SPDX-License-Identifier: MIT
// The subcommands of `sheaf`. Each returns an exit code or throws Error.
#pragma once

#include <string>

#include "output/progress.hpp"
#include "settings/render_settings.hpp"

namespace sheaf {

int run_render(RenderOptions& options, Progress& progress);
int run_inspect(const std::string& path, const std::string& scene_name, const std::string& variant, bool json);
int run_devices(bool json);
int run_options(bool json);

/// Signals that ask to stop: 0, or the signal's number. Whole frames stay, the one at work is dropped.
[[nodiscard]] int interrupted();
void watch_signals();

}  // namespace sheaf
