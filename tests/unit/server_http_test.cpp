// SPDX-License-Identifier: MIT
// Reading requests: heads, bodies, paths.
#include <gtest/gtest.h>

#include <string>

#include "http/body_reader.hpp"
#include "http/request_head.hpp"
#include "http/router.hpp"
#include "util/problem.hpp"

namespace sheaf::server {
namespace {

int status_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Problem& problem) {
    return problem.status();
  }
  return 200;
}

RequestHead head_of(const std::string& lines) {
  return parse_request_head("POST /p HTTP/1.1\r\nHost: a\r\n" + lines + "\r\n", HeadLimits{});
}

/// A body read from `bytes`, which arrive `piece` at a time, into a buffer of `room`.
std::string read_all(const RequestHead& head, std::string& bytes, std::size_t piece, std::size_t room,
                     std::uint64_t limit = 1 << 20) {
  BodyReader reader(head, limit, [&](char* into, std::size_t size) {
    const std::size_t n = std::min({size, piece, bytes.size()});
    bytes.copy(into, n);
    bytes.erase(0, n);
    return n;
  });
  std::string body, block(room, '\0');
  for (std::size_t n = 0; (n = reader.read(block.data(), room)) > 0;) body.append(block, 0, n);
  EXPECT_TRUE(reader.finished());
  return body;
}

TEST(RequestHead, TellsHowTheBodyIsCounted) {
  EXPECT_EQ(head_of("").framing, BodyFraming::none);
  EXPECT_EQ(head_of("Content-Length: 0\r\n").framing, BodyFraming::none);
  EXPECT_EQ(head_of("content-length: 7\r\n").content_length, 7u);
  EXPECT_EQ(head_of("Content-Length: 7\r\nContent-Length: 7\r\n").content_length, 7u);
  EXPECT_EQ(head_of("Transfer-Encoding: Chunked\r\n").framing, BodyFraming::chunked);
  for (const char* lines :
       {"Content-Length: 7\r\nContent-Length: 8\r\n", "Content-Length: 7, 7\r\n", "Content-Length: \r\n",
        "Content-Length: +7\r\n", "Content-Length: 0x7\r\n", "Content-Length: 18446744073709551616\r\n",
        "Transfer-Encoding: chunked\r\nContent-Length: 7\r\n", "Transfer-Encoding: identity\r\n",
        "Transfer-Encoding: chunked\r\nTransfer-Encoding: chunked\r\n", "Host: b\r\n"})
    EXPECT_EQ(status_of([&] { (void)head_of(lines); }), 400) << lines;
}

TEST(RequestHead, KeepsConnectionsAsTheVersionSays) {
  EXPECT_TRUE(head_of("").keep_alive);
  EXPECT_FALSE(head_of("Connection: Close\r\n").keep_alive);
  EXPECT_FALSE(parse_request_head("GET / HTTP/1.0\r\n\r\n", HeadLimits{}).keep_alive);
}

std::string target_of(const std::string& method, const std::string& target, const std::string& host = "a") {
  return parse_request_head(method + " " + target + " HTTP/1.1\r\nHost: " + host + "\r\n\r\n", HeadLimits{}).target;
}

TEST(RequestHead, TakesTheHostOffAnAbsoluteTarget) {
  EXPECT_EQ(target_of("GET", "/a?b"), "/a?b");
  EXPECT_EQ(target_of("GET", "http://a/b?c=http://d"), "/b?c=http://d");
  EXPECT_EQ(target_of("GET", "https://a:443//b"), "//b");
  EXPECT_EQ(target_of("GET", "hTTp://[::1]:80/b"), "/b");
  EXPECT_EQ(target_of("GET", "http://a"), "/");
  EXPECT_EQ(target_of("GET", "http://a?b"), "/?b");
  EXPECT_EQ(target_of("POST", "http://a:"), "/");
  EXPECT_EQ(target_of("OPTIONS", "http://a"), "*");
  EXPECT_EQ(target_of("OPTIONS", "http://a/"), "/");
  EXPECT_EQ(target_of("OPTIONS", "*"), "*");
  EXPECT_EQ(target_of("GET", "http://another/b", "a"), "/b");
  EXPECT_EQ(target_of("GET", "http://a/b", ""), "/b");
  for (const char* target : {"*", "a", "a/b", "http:/a", "http:a", "http://", "http:///b", "http://:80/b",
                             "http://u@a/b", "http://a:80:80/b", "http://a:x/b", "http://[::1/b", "http://[]/b",
                             "http://[::1]x/b", "http://a\\b/c", "http://a#b", "ftp://a/b", "x http://a/b", "://a/b"})
    EXPECT_EQ(status_of([&] { (void)target_of("GET", target); }), 400) << target;
}

TEST(RequestHead, WantsAHostThatIsOne) {
  for (const char* host : {"", "a", "a:80", "a:", "127.0.0.1:8080", "[::1]", "[::1]:80", "my_host", "xn--4gbrim"})
    EXPECT_EQ(status_of([&] { (void)target_of("GET", "/", host); }), 200) << host;
  for (const char* host : {"a b", "a/b", "u@a", ":80", "a:x", "a:80:80", "[::1", "http://a", "a,b:c"})
    EXPECT_EQ(status_of([&] { (void)target_of("GET", "/", host); }), 400) << host;
}

TEST(Target, IsDecodedOnce) {
  std::string path;
  std::vector<std::pair<std::string, std::string>> query;
  split_target("/a%20b/%2e%2e/c+d?x=1+2&y=%26&z&=&", path, query);
  EXPECT_EQ(path, "/a b/../c+d");
  const std::vector<std::pair<std::string, std::string>> expected{{"x", "1 2"}, {"y", "&"}, {"z", ""}, {"", ""}};
  EXPECT_EQ(query, expected);
  split_target("*", path, query);
  EXPECT_EQ(path, "*");
  for (const char* target : {"", "a", "*/", "/%", "/%4", "/%g0", "/%00", "/?%0a", "http://a/"})
    EXPECT_EQ(status_of([&] { split_target(target, path, query); }), 400) << target;
}

TEST(BodyReader, GivesTheSameBodyWhateverThePieces) {
  const std::string chunked = "3\r\nabc\r\nA;ext=\"1\"\r\n0123456789\r\n000\r\nTrailer: x\r\n\r\nNEXT";
  for (const std::size_t piece : {1, 2, 3, 7, 100})
    for (const std::size_t room : {1, 2, 5, 64}) {
      std::string bytes = chunked;
      EXPECT_EQ(read_all(head_of("Transfer-Encoding: chunked\r\n"), bytes, piece, room), "abc0123456789");
      EXPECT_EQ(bytes, "NEXT");  // not a byte more
      bytes = "0123456NEXT";
      EXPECT_EQ(read_all(head_of("Content-Length: 7\r\n"), bytes, piece, room), "0123456");
      EXPECT_EQ(bytes, "NEXT");
    }
}

TEST(BodyReader, RefusesWhatIsTooLargeBeforeReadingIt) {
  std::string bytes(100, 'x');
  EXPECT_EQ(status_of([&] { read_all(head_of("Content-Length: 11\r\n"), bytes, 8, 8, 10); }), 413);
  EXPECT_EQ(bytes.size(), 100u);
  for (const char* text : {"b\r\n0123456789a\r\n0\r\n\r\n", "5\r\n01234\r\n6\r\n012345\r\n0\r\n\r\n",
                           "5\r\n01234\r\nffffffffffffffff\r\n"}) {
    bytes = text;
    EXPECT_EQ(status_of([&] { read_all(head_of("Transfer-Encoding: chunked\r\n"), bytes, 8, 8, 10); }), 413) << text;
  }
  bytes = "a\r\n0123456789\r\n0\r\n\r\n";
  EXPECT_EQ(read_all(head_of("Transfer-Encoding: chunked\r\n"), bytes, 8, 8, 10), "0123456789");
}

TEST(BodyReader, RefusesWhatIsMalformedOrCutOff) {
  for (const char* text : {"", "3", "3\r\n", "3\r\nab", "3\r\nabc", "3\r\nabcX\r\n", "3\nabc\r\n0\r\n\r\n", "g\r\n",
                           "0\r\n", "0\r\nTrailer", "10000000000000000\r\n", "-1\r\n", "\r\n"}) {
    std::string bytes = text;
    EXPECT_EQ(status_of([&] { read_all(head_of("Transfer-Encoding: chunked\r\n"), bytes, 8, 8); }), 400) << text;
  }
  std::string bytes = "012345";
  EXPECT_EQ(status_of([&] { read_all(head_of("Content-Length: 7\r\n"), bytes, 8, 8); }), 400);
}

TEST(Router, FindsPlaceholdersWithTextAroundThem) {
  Router router;
  std::string seen;
  router.add("GET", "/jobs/{id}/frames/{frame}.exr", [&](Request& request) {
    seen = request.parameters["id"] + ":" + request.parameters["frame"];
    return Reply{};
  });
  const auto status = [&](const std::string& method, const std::string& path) {
    seen.clear();
    Request request;
    request.method = method;
    request.path = path;
    return status_of([&] { (void)router.dispatch(request); });
  };
  EXPECT_EQ(status("GET", "/jobs/a/frames/12.exr"), 200);
  EXPECT_EQ(seen, "a:12");
  EXPECT_EQ(status("HEAD", "/jobs/a/frames/1.2.exr"), 200);
  EXPECT_EQ(seen, "a:1.2");
  EXPECT_EQ(status("POST", "/jobs/a/frames/12.exr"), 405);
  for (const char* path :
       {"/jobs/a/frames/.exr", "/jobs//frames/1.exr", "/jobs/a/frames/1.exr/", "jobs/a/frames/1.exr", ""})
    EXPECT_EQ(status("GET", path), 404) << path;
}

}  // namespace
}  // namespace sheaf::server
