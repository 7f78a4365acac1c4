// SPDX-License-Identifier: MIT
// The server over real sockets, with many more slow clients than threads. Made for thread sanitizers too.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>

#include <array>
#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include "http/http_server.hpp"
#include "util/fd.hpp"

namespace sheaf::server {
namespace {

HttpOptions few_threads() {
  HttpOptions options;
  options.pool = {.threads = 2, .max_stalled = 3, .patience = std::chrono::milliseconds(20)};
  options.timeouts.read = options.timeouts.write = std::chrono::seconds(60);
  return options;
}

/// Reads the body and says how long it was.
Reply answer(Request& request) {
  std::array<char, 64> block{};
  std::size_t total = 0;
  while (const std::size_t n = request.read_body(block.data(), block.size())) total += n;
  return text_reply("text/plain", std::to_string(total));
}

class Running {
 public:
  Running()
      : server_(few_threads(), answer, [this](const ExchangeRecord& record) { finished_ += record.status == 200; }) {
    const std::string name = server_.bind("127.0.0.1", "0");
    port_ = static_cast<std::uint16_t>(std::stoi(name.substr(name.rfind(':') + 1)));
    thread_ = std::thread([this] { server_.run(); });
  }
  ~Running() {
    server_.stop();
    thread_.join();
  }

  [[nodiscard]] Fd connect() const {
    Fd fd(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port_);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    return fd;
  }
  [[nodiscard]] int finished() const { return finished_; }

 private:
  std::atomic<int> finished_{0};
  HttpServer server_;
  std::uint16_t port_ = 0;
  std::thread thread_;
};

void send_all(const Fd& fd, std::string_view text) {
  ASSERT_EQ(::send(fd.get(), text.data(), text.size(), MSG_NOSIGNAL), static_cast<ssize_t>(text.size()));
}

/// Everything until the server closes.
std::string receive_all(const Fd& fd) {
  std::string all;
  std::array<char, 4096> block{};
  for (ssize_t n = 0; (n = ::recv(fd.get(), block.data(), block.size(), 0)) > 0;)
    all.append(block.data(), static_cast<std::size_t>(n));
  return all;
}

constexpr const char* half = "POST / HTTP/1.1\r\nHost: a\r\nContent-Length: 10\r\n\r\nabc";
constexpr const char* whole = "POST / HTTP/1.1\r\nHost: a\r\nConnection: close\r\nContent-Length: 3\r\n\r\nabc";

TEST(HttpServer, SlowClientsHoldUpNobody) {
  const Running server;
  std::vector<Fd> slow;
  for (int i = 0; i < 20; ++i) send_all(slow.emplace_back(server.connect()), half);
  std::vector<std::thread> others;
  for (int i = 0; i < 4; ++i)
    others.emplace_back([&server] {
      for (int k = 0; k < 20; ++k) {
        const Fd fd = server.connect();
        send_all(fd, whole);
        const std::string reply = receive_all(fd);
        EXPECT_TRUE(reply.starts_with("HTTP/1.1 200") && reply.ends_with("\r\n\r\n3")) << reply;
      }
    });
  for (std::thread& thread : others) thread.join();
  EXPECT_EQ(server.finished(), 80);
}

TEST(HttpServer, ASlowClientThatGoesOnIsServed) {
  const Running server;
  std::vector<Fd> slow;
  for (int i = 0; i < 3; ++i) send_all(slow.emplace_back(server.connect()), half);
  const Fd other = server.connect();
  send_all(other, whole);
  EXPECT_TRUE(receive_all(other).starts_with("HTTP/1.1 200"));
  for (const Fd& fd : slow) {
    send_all(fd, "defghij");
    ::shutdown(fd.get(), SHUT_WR);
    EXPECT_TRUE(receive_all(fd).ends_with("\r\n\r\n10"));
  }
}

TEST(HttpServer, StopsWithClientsInEveryState) {
  std::vector<Fd> slow;
  const Running server;
  for (int i = 0; i < 6; ++i) send_all(slow.emplace_back(server.connect()), half);
  slow.push_back(server.connect());  // idle
  send_all(slow.emplace_back(server.connect()), "GET / HT");
}

}  // namespace
}  // namespace sheaf::server
