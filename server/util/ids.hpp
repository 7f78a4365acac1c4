// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

namespace sheaf::server {

/// 128 bits from the kernel as 26 characters of lower-case base32 (RFC 4648): nobody can guess another one's job.
[[nodiscard]] std::string random_id();

/// Whether `text` looks like what random_id gives; anything else never reaches a path.
[[nodiscard]] bool is_id(std::string_view text);

}  // namespace sheaf::server
