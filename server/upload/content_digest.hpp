// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>

#include "http/message.hpp"

namespace sheaf::server {

/// The body's SHA-256 as declared by a Content-Digest header (RFC 9530), as 64 lower-case hexadecimal digits; nothing
/// if there is none, or only digests of other kinds. Throws Problem (400) for one that is malformed.
[[nodiscard]] std::optional<std::string> declared_sha256(const Request& request);

}  // namespace sheaf::server
