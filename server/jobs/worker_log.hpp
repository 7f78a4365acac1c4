// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "util/fd.hpp"

namespace sheaf::server {

/// Writes a worker's log to the job's log.txt, bounded and without the service's own paths.
class WorkerLog {
 public:
  /// `hidden`: a path that clients need not know; where it starts a file's path, only the rest is kept.
  WorkerLog(const std::filesystem::path& path, std::uint64_t limit, std::string hidden);

  void append(std::string_view bytes);  // any bytes; lines are put together
  void line(std::string_view text);
  void end();  // a last line that was not ended

  [[nodiscard]] const std::string& last_line() const { return last_; }
  [[nodiscard]] std::string without_paths(std::string_view text) const;

 private:
  Fd file_;
  std::uint64_t left_;
  std::string hidden_, partial_, last_;
};

}  // namespace sheaf::server
