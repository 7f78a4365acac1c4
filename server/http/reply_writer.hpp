// SPDX-License-Identifier: MIT
// Replies as HTTP/1.1 messages (RFC 9112): status line, headers, and a body whose end the client can tell.
#pragma once

#include <string>
#include <string_view>

#include "http/client_stream.hpp"
#include "http/message.hpp"
#include "http/request_head.hpp"

namespace sheaf::server {

enum class ReplyFraming {
  none,          // 204 and 304 have no body and no Content-Length
  length,        // Content-Length
  chunked,       // Transfer-Encoding: chunked
  until_closed,  // of unknown length, for a client of HTTP/1.0, which has no chunks
};

[[nodiscard]] ReplyFraming framing_of(const Reply& reply, bool http_1_0);

/// Status line and headers, with the blank line. Unless `keep`, they announce that the connection ends.
[[nodiscard]] std::string reply_head(const Reply& reply, ReplyFraming framing, bool keep);

/// A chunk with its size. `bytes` is not empty: an empty chunk ends a body.
[[nodiscard]] std::string as_chunk(std::string_view bytes);
inline constexpr std::string_view last_chunk = "0\r\n\r\n";

/// Writes a reply to the request of `head`. False if it is not whole: the client has gone or is too slow, or the body
/// could not be made; the connection must end then, so that the client does not take a part for the whole. A reply that
/// lasts is not for this function, but for the stream pump.
[[nodiscard]] bool write_reply(ClientStream& stream, const Reply& reply, const RequestHead& head, bool keep);

}  // namespace sheaf::server
