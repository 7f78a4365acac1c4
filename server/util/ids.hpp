// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

namespace sheaf::server {

/// 128 bits from the kernel as 26 characters of lower-case base32 (RFC 4648): nobody can guess the id of another
/// client's job.
[[nodiscard]] std::string random_id();

/// Whether `text` has the form of random_id()'s result; nothing else is used in a path.
[[nodiscard]] bool is_id(std::string_view text);

}  // namespace sheaf::server
