// SPDX-License-Identifier: MIT
#include "http/http_server.hpp"

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "http/exchange.hpp"
#include "http/guarded.hpp"
#include "util/ids.hpp"
#include "util/log.hpp"
#include "util/problem.hpp"

namespace sheaf::server {
namespace {

using Clock = std::chrono::steady_clock;

void watch(int epoll, int fd, std::uint32_t events) {
  epoll_event event{};
  event.events = events;
  event.data.fd = fd;
  if (::epoll_ctl(epoll, EPOLL_CTL_MOD, fd, &event) != 0) ::epoll_ctl(epoll, EPOLL_CTL_ADD, fd, &event);
}

std::string bound_name(int fd) {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  ::getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size);
  std::array<char, NI_MAXHOST> host{};
  std::array<char, NI_MAXSERV> port{};
  ::getnameinfo(reinterpret_cast<sockaddr*>(&address), size, host.data(), host.size(), port.data(), port.size(),
                NI_NUMERICHOST | NI_NUMERICSERV);
  const std::string name = host.data();
  return (name.find(':') == std::string::npos ? name : "[" + name + "]") + ":" + port.data();
}

}  // namespace

HttpServer::HttpServer(HttpOptions options, Handler handler, Observer observer)
    : options_(options),
      handler_(std::move(handler)),
      observer_(std::move(observer)),
      epoll_(::epoll_create1(EPOLL_CLOEXEC)),
      wake_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)),
      pool_(options.pool, [this](ConnectionPtr connection) { serve(std::move(connection)); }),
      pump_(options.timeouts.write, [this](ConnectionPtr connection, const ExchangeRecord& record, bool keep) {
        if (observer_) observer_(record);
        if (keep && !stopping_) return park(std::move(connection));
        discard(std::move(connection));
      }) {
  if (!epoll_.valid() || !wake_.valid()) throw io_error("epoll", std::strerror(errno));
  install_exchange(*this);
  svr_sock_ = epoll_.get();  // the library takes any valid descriptor for "running"
  rehearse([this](httplib::Stream& stream) { return run_exchange(*this, &HttpServer::process_request, stream); });
  watch(epoll_.get(), wake_.get(), EPOLLIN);
}

HttpServer::~HttpServer() = default;

std::string HttpServer::bind(const std::string& host, const std::string& port) {
  const std::string name = host + ":" + port;
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
  addrinfo* found = nullptr;
  if (const int error = ::getaddrinfo(host.empty() ? nullptr : host.c_str(), port.c_str(), &hints, &found))
    throw io_error("listen " + name, ::gai_strerror(error));
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> owner(found, &::freeaddrinfo);
  int failure = 0;
  for (const addrinfo* a = found; a; a = a->ai_next) {
    Fd fd(::socket(a->ai_family, a->ai_socktype | SOCK_CLOEXEC | SOCK_NONBLOCK, a->ai_protocol));
    const int on = 1;
    if (fd.valid()) ::setsockopt(fd.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    if (fd.valid() && ::bind(fd.get(), a->ai_addr, a->ai_addrlen) == 0 && ::listen(fd.get(), 512) == 0) {
      listener_ = std::move(fd);
      break;
    }
    failure = errno;
  }
  if (!listener_.valid()) throw io_error("listen " + name, std::strerror(failure));
  watch(epoll_.get(), listener_.get(), EPOLLIN);
  return bound_name(listener_.get());
}

void HttpServer::run() {
  pool_.start();
  std::array<epoll_event, 64> events{};
  bool soon = false;
  while (!stopping_) {
    const int n = ::epoll_wait(epoll_.get(), events.data(), static_cast<int>(events.size()), soon ? 20 : 1000);
    for (int i = 0; i < n; ++i) {
      const int fd = events[static_cast<std::size_t>(i)].data.fd;
      if (fd == listener_.get())
        accept_clients();
      else if (fd != wake_.get())
        wake_connection(fd);
    }
    close_idle(Clock::now() - options_.keep_alive);
    soon = pool_.tick();
  }
  listener_.reset();
  close_idle(Clock::time_point::max());
  pool_.shut_down_sockets(SHUT_RD);
  pool_.drain(Clock::now() + options_.drain);
  pump_.stop(Clock::now() + options_.drain);
  svr_sock_ = INVALID_SOCKET;
  pool_.shut_down_sockets(SHUT_RDWR);
  pool_.join();
}

void HttpServer::stop() {
  stopping_ = true;
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t n = ::write(wake_.get(), &one, sizeof one);
}

void HttpServer::accept_clients() {
  while (true) {
    Fd fd(::accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
    if (!fd.valid()) {
      if (errno == EINTR || errno == ECONNABORTED) continue;
      if (errno == EMFILE || errno == ENFILE) close_idle(Clock::now());  // idle clients can connect again
      return;
    }
    const int on = 1;
    ::setsockopt(fd.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    if (open_ >= options_.max_connections) {
      static constexpr std::string_view full =
          "HTTP/1.1 503 Service Unavailable\r\nConnection: close\r\nContent-Length: 0\r\nRetry-After: 1\r\n\r\n";
      ::send(fd.get(), full.data(), full.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
      continue;
    }
    ++open_;
    park(std::make_unique<Connection>(std::move(fd), options_.timeouts, options_.head));
  }
}

void HttpServer::park(ConnectionPtr connection) {
  const int fd = connection->stream.fd();
  connection->idle_since = Clock::now();
  pool_.release(fd);
  if (stopping_) return discard(std::move(connection));
  const std::lock_guard lock(mutex_);
  idle_[fd] = std::move(connection);
  watch(epoll_.get(), fd, EPOLLIN | EPOLLRDHUP | EPOLLONESHOT);
}

void HttpServer::wake_connection(int fd) {
  ConnectionPtr connection;
  {
    const std::lock_guard lock(mutex_);
    const auto found = idle_.find(fd);
    if (found == idle_.end()) return;
    connection = std::move(found->second);
    idle_.erase(found);
  }
  pool_.add(std::move(connection));
}

void HttpServer::close_idle(Clock::time_point before) {
  const std::lock_guard lock(mutex_);
  open_ -= std::erase_if(idle_, [before](const auto& entry) { return entry.second->idle_since <= before; });
}

void HttpServer::serve(ConnectionPtr connection) {
  bool keep = true;
  do {
    try {
      keep = serve_one(connection);
    } catch (const std::exception& error) {
      write_log(LogLevel::error, "connection dropped", {{"reason", error.what()}});
      keep = false;
    }
  } while (keep && !stopping_ && connection->stream.has_buffered());
  if (!connection) return;  // handed over
  if (keep && !stopping_) return park(std::move(connection));
  discard(std::move(connection));
}

void HttpServer::discard(ConnectionPtr connection) {
  pool_.release(connection->stream.fd());
  connection.reset();
  --open_;
}

/// True if another request may follow on the connection; it is null if it was handed over.
bool HttpServer::serve_one(ConnectionPtr& connection) {
  ClientStream& stream = connection->stream;
  const auto started = Clock::now();
  std::optional<RequestHead> head;
  try {
    head = stream.read_head();
  } catch (const Problem& problem) {
    return refuse_head(stream, problem);
  }
  if (!head) return false;
  stream.begin(*head, options_.max_body);

  ExchangeRecord record;
  record.id = random_id().substr(0, 16);
  record.method = head->method;
  Reply reply = answer(*head, stream, record);
  if (reply.lasting && head->method != "HEAD") {
    hand_over(std::move(connection), *head, std::move(reply), record, started);
    return false;
  }
  const ExchangeScope scope([&](httplib::Response& response) { fill(response, std::move(reply), *head); });
  const bool sent = run_exchange(*this, &HttpServer::process_request, stream);
  record.seconds = Clock::now() - started;
  if (observer_) observer_(record);

  if (!stream.body_finished()) stream.close_lingering();
  return sent && head->keep_alive && stream.body_finished();
}

/// What the client sends meanwhile stays in its socket until the reply is over.
void HttpServer::hand_over(ConnectionPtr connection, const RequestHead& head, Reply reply, const ExchangeRecord& record,
                           Clock::time_point started) {
  const bool chunked = !head.http_1_0;
  const bool keep = head.keep_alive && connection->stream.body_finished() && !connection->stream.has_buffered();
  pool_.release(connection->stream.fd());
  std::string text = lasting_head(reply, chunked, keep);
  pump_.add({std::move(connection), std::move(text), *std::move(reply.lasting), chunked, keep, record, started});
}

Reply HttpServer::answer(const RequestHead& head, ClientStream& stream, ExchangeRecord& record) {
  Request request;
  request.method = head.method;
  request.headers = head.headers;
  request.id = record.id;
  request.path = head.target;
  request.read_body = [&stream](char* into, std::size_t size) { return stream.read_body(into, size); };
  Reply reply = guarded(request, [&](Request& checked) {
    checked.path.clear();
    split_target(head.target, checked.path, checked.query);
    return handler_(checked);
  });
  record.path = request.path;
  record.job = request.parameters.contains("id") ? request.parameters["id"] : "";
  record.client = request.client;
  record.status = reply.status;
  record.refusal = reply.refusal;
  reply.header("X-Request-Id", record.id);
  if (!stream.body_finished() && head.keep_alive) reply.header("Connection", "close");
  return reply;
}

bool HttpServer::refuse_head(ClientStream& stream, const Problem& problem) {
  ExchangeRecord record;
  record.status = problem.status();
  record.refusal = problem.slug();
  const std::string text = plain_refusal(problem);
  for (std::size_t at = 0; at < text.size();) {
    const ssize_t n = stream.write(text.data() + at, text.size() - at);
    if (n < 0) break;
    at += static_cast<std::size_t>(n);
  }
  stream.close_lingering();
  if (observer_) observer_(record);
  return false;
}

}  // namespace sheaf::server
