// SPDX-License-Identifier: MIT
// Replies as they go over the wire: how a client can tell where the body ends, and that it can tell a part from the
// whole.
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <string>

#include "http/reply_writer.hpp"

namespace sheaf::server {
namespace {

struct Sent {
  bool whole = false;
  std::string text;
};

/// What a client receives. Replies here fit into a socket's buffer.
Sent send(const Reply& reply, const RequestHead& head, bool keep = true) {
  std::array<int, 2> ends{};
  EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()), 0);
  const Fd client(ends[0]);
  Sent sent;
  {
    ClientStream stream(Fd(ends[1]), {}, {});
    sent.whole = write_reply(stream, reply, head, keep);
  }
  std::array<char, 4096> block{};
  for (ssize_t n = 0; (n = ::read(client.get(), block.data(), block.size())) > 0;)
    sent.text.append(block.data(), static_cast<std::size_t>(n));
  return sent;
}

RequestHead head_of(const std::string& method, bool http_1_0 = false) {
  RequestHead head;
  head.method = method;
  head.http_1_0 = http_1_0;
  return head;
}

Reply streamed(std::optional<std::uint64_t> length, bool whole = true) {
  Reply reply;
  reply.content_type = "text/plain";
  reply.stream =
      StreamBody{length, [whole](const Writer& write) { return write("one") && write("") && write("two") && whole; }};
  return reply;
}

const std::string common = "Content-Type: text/plain\r\nX-Content-Type-Options: nosniff\r\n";

TEST(ReplyWriter, CountsBytesOfTextAndOfStreamsOfKnownLength) {
  Reply text = text_reply("text/plain", "hello");
  text.header("ETag", "\"x\"");
  EXPECT_EQ(send(text, head_of("GET")).text,
            "HTTP/1.1 200 OK\r\nETag: \"x\"\r\n" + common + "Content-Length: 5\r\n\r\nhello");
  EXPECT_EQ(send(text_reply("text/plain", ""), head_of("GET")).text,
            "HTTP/1.1 200 OK\r\n" + common + "Content-Length: 0\r\n\r\n");
  EXPECT_EQ(send(streamed(6), head_of("GET"), false).text,
            "HTTP/1.1 200 OK\r\n" + common + "Content-Length: 6\r\nConnection: close\r\n\r\nonetwo");
}

TEST(ReplyWriter, SendsUnknownLengthsInChunksAndToOldClientsUntilTheEnd) {
  EXPECT_EQ(send(streamed(std::nullopt), head_of("GET")).text,
            "HTTP/1.1 200 OK\r\n" + common + "Transfer-Encoding: chunked\r\n\r\n3\r\none\r\n3\r\ntwo\r\n0\r\n\r\n");
  EXPECT_EQ(send(streamed(std::nullopt), head_of("GET", true), false).text,
            "HTTP/1.1 200 OK\r\n" + common + "Connection: close\r\n\r\nonetwo");
  EXPECT_EQ(as_chunk(std::string(255, 'x')), "ff\r\n" + std::string(255, 'x') + "\r\n");
}

TEST(ReplyWriter, SendsNoBodyWhereNoneBelongs) {
  EXPECT_EQ(send(text_reply("text/plain", "hello"), head_of("HEAD")).text,
            "HTTP/1.1 200 OK\r\n" + common + "Content-Length: 5\r\n\r\n");
  EXPECT_EQ(send(streamed(6), head_of("HEAD")).text, "HTTP/1.1 200 OK\r\n" + common + "Content-Length: 6\r\n\r\n");
  Reply unchanged;
  unchanged.status = 304;
  EXPECT_EQ(send(unchanged, head_of("GET")).text,
            "HTTP/1.1 304 Not Modified\r\nX-Content-Type-Options: nosniff\r\n\r\n");
}

TEST(ReplyWriter, ABodyThatBreaksOffDoesNotLookWhole) {
  const Sent chunked = send(streamed(std::nullopt, false), head_of("GET"));
  EXPECT_FALSE(chunked.whole);
  EXPECT_TRUE(chunked.text.ends_with("\r\n\r\n3\r\none\r\n3\r\ntwo\r\n"));
  EXPECT_FALSE(send(streamed(7, false), head_of("GET")).whole);
}

TEST(ReplyWriter, ToldThatTheClientHasGoneItStops) {
  std::array<int, 2> ends{};
  ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()), 0);
  ::close(ends[0]);
  ClientStream stream(Fd(ends[1]), {}, {});
  int asked = 0;
  Reply reply;
  reply.stream = StreamBody{std::nullopt, [&asked](const Writer& write) {
                              ++asked;
                              return write("more");
                            }};
  EXPECT_FALSE(write_reply(stream, reply, head_of("GET"), true));
  EXPECT_EQ(asked, 0);
}

}  // namespace
}  // namespace sheaf::server
