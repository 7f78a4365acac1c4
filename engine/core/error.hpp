// SPDX-License-Identifier: MIT
// One exception type for every failure a user can cause or meet. Its kind is the process exit code of `sheaf`
// and is mapped to HTTP once, in the server; its text names the file, the place in it and the reason. It is one line of
// valid UTF-8 whatever it repeats; a user's string in it is cut by core/quote.hpp.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

#include "core/quote.hpp"

namespace sheaf {

enum class ErrorKind : int {
  usage = 2,         // wrong command line
  input = 3,         // scene, camera path or settings are bad
  device = 4,        // no usable device, or it was lost
  limit = 5,         // a stated limit was exceeded
  io = 6,            // reading or writing failed
  interrupted = 130  // SIGINT; SIGTERM gives 143
};

class Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, const std::string& reason) : std::runtime_error(one_line(bounded_words(reason))), kind_(kind) {}
  [[nodiscard]] ErrorKind kind() const noexcept { return kind_; }
  [[nodiscard]] int exit_code() const noexcept { return static_cast<int>(kind_); }

 private:
  ErrorKind kind_;
};

[[nodiscard]] inline Error input_error(const std::string& where, const std::string& reason) {
  return {ErrorKind::input, where + ": " + reason};
}
[[nodiscard]] inline Error io_error(const std::string& where, const std::string& reason) {
  return {ErrorKind::io, where + ": " + reason};
}
[[nodiscard]] inline Error limit_error(const std::string& where, const std::string& reason) {
  return {ErrorKind::limit, where + ": " + reason};
}

}  // namespace sheaf
