// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "util/fd.hpp"

namespace sheaf::server {

/// A file being received. Throws Problem (422) if the name is taken, Error{io} if it cannot be written.
class NewFile {
 public:
  /// `relative` is checked (safe_relative_path) and lies in `folder`; missing folders are created.
  NewFile(const std::filesystem::path& folder, const std::filesystem::path& relative);
  void write(std::string_view bytes);
  void close();
  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }

 private:
  std::string name_;
  Fd fd_;
  std::uint64_t bytes_ = 0;
};

}  // namespace sheaf::server
