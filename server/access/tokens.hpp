// SPDX-License-Identifier: MIT
// Who may do what: bearer tokens (RFC 6750), known to the service by their SHA-256 alone. Tokens are 256 random bits,
// so that a plain hash of one tells nobody the token.
#pragma once

#include <string>
#include <vector>

#include "http/message.hpp"

namespace sheaf::server {

enum class Scope : unsigned { read = 1, submit = 2 };

class Tokens {
 public:
  /// Without a file everybody may do everything.
  Tokens() = default;

  /// Lines "NAME SCOPES sha256:HEX", SCOPES being read, submit or both with a comma; '#' starts a comment. Throws
  /// Error{io, input} naming the line.
  explicit Tokens(const std::string& path);

  [[nodiscard]] bool required() const { return required_; }

  /// The name of the request's token; empty where none is required. Throws Problem: 401, or 403 without the scope.
  [[nodiscard]] std::string authorize(const Request& request, Scope scope) const;

 private:
  struct Entry {
    std::string name, hash;
    unsigned scopes = 0;
  };
  void read_line(const std::string& path, std::size_t number, const std::string& line);

  bool required_ = false;
  std::vector<Entry> entries_;
};

struct NewToken {
  std::string token, line;  // what its owner keeps, and what the token file is given
};

/// `text` is "NAME=SCOPES". Throws Error{usage}.
[[nodiscard]] NewToken make_token(const std::string& text);

}  // namespace sheaf::server
