// SPDX-License-Identifier: MIT
// Restricts a worker, which reads untrusted files, to its own job. Prepared before the fork; applied in the child by
// system calls alone. Measures that the kernel does not have are left out; apply() says which hold.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "jobs/system_call_filter.hpp"
#include "util/fd.hpp"

namespace sheaf::server {

struct ConfinementOptions {
  bool on = true;
  std::uint64_t memory_bytes = std::uint64_t{16} << 30;  // of private memory: RLIMIT_DATA
  std::uint64_t cpu_seconds = 86'400;                    // of processor time
  std::uint64_t file_bytes = std::uint64_t{8} << 30;     // of one file
  int nice = 10;                      // beyond the service's own, so that the service answers while its workers render
  std::vector<std::string> readable;  // beyond the system's own folders, the worker's program and its job
};

class Confinement {
 public:
  /// For a worker that is `program` and writes in `folder` (empty: nowhere).
  Confinement(const ConfinementOptions& options, const std::string& program, const std::filesystem::path& folder);

  enum Measure : unsigned { limits = 1, no_new_privileges = 2, files = 4, system_calls = 8 };

  /// In the forked child; async-signal-safe. Returns the measures that hold, or'ed.
  [[nodiscard]] unsigned apply() const noexcept;

 private:
  ConfinementOptions options_;
  Fd ruleset_;
  const SystemCallFilter* filter_;
};

/// The names of the measures that hold on this machine, tried in a child.
[[nodiscard]] std::vector<std::string> active_measures(const ConfinementOptions& options);

/// Names of all there are.
[[nodiscard]] std::vector<std::string> all_measures();

}  // namespace sheaf::server
