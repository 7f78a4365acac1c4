// SPDX-License-Identifier: MIT
// What a path to write to leads to: a file that a rename can replace, or something that takes bytes as they come.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

namespace sheaf {

struct WriteTarget {
  /// What a rename replaces: the path itself, or the end of its symbolic links, which may not exist yet.
  std::string path;
  /// A FIFO, a device or an open descriptor (/dev/stdout, /dev/fd/N): written, never replaced.
  bool is_stream = false;
  std::optional<int> descriptor;  // of this process, where the path names one
};

/// Follows symbolic links. A path that cannot be followed (a loop, no permission) is its own target.
[[nodiscard]] WriteTarget find_write_target(const std::string& path);

/// Opens a stream and writes all of `bytes`; waits for a FIFO's reader. 0, or the errno of what failed. A reader that
/// goes away is EPIPE and no signal.
[[nodiscard]] int write_to_stream(const WriteTarget& target, std::span<const std::byte> bytes);

}  // namespace sheaf
