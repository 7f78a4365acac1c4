// SPDX-License-Identifier: MIT
#include "http/reply_writer.hpp"

#include <array>
#include <charconv>
#include <map>

namespace sheaf::server {
namespace {

std::string_view reason_phrase(int status) {
  static const std::map<int, std::string_view> phrases{{200, "OK"},
                                                       {202, "Accepted"},
                                                       {204, "No Content"},
                                                       {206, "Partial Content"},
                                                       {304, "Not Modified"},
                                                       {400, "Bad Request"},
                                                       {401, "Unauthorized"},
                                                       {403, "Forbidden"},
                                                       {404, "Not Found"},
                                                       {405, "Method Not Allowed"},
                                                       {408, "Request Timeout"},
                                                       {409, "Conflict"},
                                                       {410, "Gone"},
                                                       {413, "Content Too Large"},
                                                       {414, "URI Too Long"},
                                                       {415, "Unsupported Media Type"},
                                                       {416, "Range Not Satisfiable"},
                                                       {422, "Unprocessable Content"},
                                                       {431, "Request Header Fields Too Large"},
                                                       {500, "Internal Server Error"},
                                                       {501, "Not Implemented"},
                                                       {503, "Service Unavailable"}};
  const auto found = phrases.find(status);
  return found == phrases.end() ? "" : found->second;  // a phrase may be empty (RFC 9112, 4)
}

bool write_stream(ClientStream& stream, const StreamBody& body, ReplyFraming framing) {
  if (framing != ReplyFraming::chunked)
    return body.produce([&stream](std::string_view bytes) { return stream.write(bytes); });
  const auto write_chunk = [&stream](std::string_view bytes) { return bytes.empty() || stream.write(as_chunk(bytes)); };
  return body.produce(write_chunk) && stream.write(last_chunk);
}

}  // namespace

ReplyFraming framing_of(const Reply& reply, bool http_1_0) {
  if (reply.status == 204 || reply.status == 304) return ReplyFraming::none;
  if (!reply.lasting && (!reply.stream || reply.stream->length)) return ReplyFraming::length;
  return http_1_0 ? ReplyFraming::until_closed : ReplyFraming::chunked;
}

std::string reply_head(const Reply& reply, ReplyFraming framing, bool keep) {
  std::string head = "HTTP/1.1 " + std::to_string(reply.status) + " ";
  head += reason_phrase(reply.status);
  const auto add = [&head](std::string_view name, std::string_view value) {
    head.append("\r\n").append(name).append(": ").append(value);
  };
  for (const auto& [name, value] : reply.headers) add(name, value);
  if (!reply.content_type.empty()) add("Content-Type", reply.content_type);
  add("X-Content-Type-Options", "nosniff");
  if (framing == ReplyFraming::length)
    add("Content-Length", std::to_string(reply.stream ? reply.stream->length.value_or(0) : reply.body.size()));
  if (framing == ReplyFraming::chunked) add("Transfer-Encoding", "chunked");
  if (!keep) add("Connection", "close");
  return head + "\r\n\r\n";
}

std::string as_chunk(std::string_view bytes) {
  std::array<char, 20> size{};
  const auto end = std::to_chars(size.data(), size.data() + size.size(), bytes.size(), 16).ptr;
  return std::string(size.data(), end).append("\r\n").append(bytes).append("\r\n");
}

bool write_reply(ClientStream& stream, const Reply& reply, const RequestHead& head, bool keep) {
  const ReplyFraming framing = framing_of(reply, head.http_1_0);
  std::string text = reply_head(reply, framing, keep);
  const bool with_body = head.method != "HEAD" && framing != ReplyFraming::none;
  if (with_body && !reply.stream) text += reply.body;  // one packet for most replies
  if (!stream.write(text)) return false;
  return !with_body || !reply.stream || write_stream(stream, *reply.stream, framing);
}

}  // namespace sheaf::server
