// SPDX-License-Identifier: MIT
// Who may do what: bearer tokens (RFC 6750). The service stores only their SHA-256; tokens are 256 random bits, so the
// hash cannot be reversed by guessing.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "http/message.hpp"

namespace sheaf::server {

enum class Scope : unsigned { read = 1, submit = 2 };

class Tokens {
 public:
  /// Without a file (an empty path) everybody may do everything.
  Tokens() = default;

  /// Lines "NAME SCOPES sha256:HEX", SCOPES being read, submit or both with a comma; '#' starts a comment. Throws
  /// Error{io, input} naming the line. The file is read again once it has changed: who was taken out of it is refused
  /// from the next request on. While it cannot be read or has a bad line, the last valid version stays in force, and
  /// the log says so.
  explicit Tokens(const std::string& path);

  [[nodiscard]] bool required() const { return !path_.empty(); }

  /// The name of the request's token; empty where none is required. Throws Problem: 401, or 403 without the scope.
  [[nodiscard]] std::string authorize(const Request& request, Scope scope) const;

 private:
  struct Entry {
    std::string name, hash;
    unsigned scopes = 0;
  };
  using Entries = std::vector<Entry>;

  /// Identifies one state of a file; equal for any two that cannot be read.
  struct Version {
    std::uint64_t device = 0, inode = 0, size = 0;
    std::int64_t changed_ns = -1;  // ctime: set by every way to change a file or to put another in its place
    bool operator==(const Version&) const = default;
  };

  [[nodiscard]] static Version version_of(const std::string& path);
  [[nodiscard]] static Entries read(const std::string& path);
  static void read_line(const std::string& path, std::size_t number, const std::string& line, Entries& entries);
  [[nodiscard]] std::shared_ptr<const Entries> current() const;

  std::string path_;
  mutable std::mutex mutex_;
  mutable Version version_;
  mutable std::shared_ptr<const Entries> entries_;
};

struct NewToken {
  std::string token, line;  // for its owner, and for the token file
};

/// `text` is "NAME=SCOPES". Throws Error{usage}.
[[nodiscard]] NewToken make_token(const std::string& text);

}  // namespace sheaf::server
