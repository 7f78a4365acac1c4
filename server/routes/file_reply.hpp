// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>

#include "http/message.hpp"
#include "jobs/job.hpp"

namespace sheaf::server {

/// A file as a reply: strong ETag, If-None-Match (304), one Range (206, 416), If-Range (RFC 9110, 13 and 14). Throws
/// Problem: 416, and 500 if the file has changed.
[[nodiscard]] Reply file_reply(const Request& request, const std::filesystem::path& path, const StoredFile& file,
                               const std::string& content_type);

[[nodiscard]] std::string etag_of(const std::string& sha256);

/// Whether If-None-Match names the ETag: the client has the file.
[[nodiscard]] bool client_has(const Request& request, const std::string& etag);

/// 304 with the caching headers of a 200.
[[nodiscard]] Reply not_modified(const std::string& etag);

/// Sends `length` bytes of the open file from `offset` on.
[[nodiscard]] bool send_file(int fd, std::uint64_t offset, std::uint64_t length, const Writer& write);

}  // namespace sheaf::server
