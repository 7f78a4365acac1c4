// SPDX-License-Identifier: MIT
#include "http/exchange.hpp"

#include <algorithm>

#include "core/error.hpp"

namespace sheaf::server {
namespace {

// The library runs a request on the thread that asked for it, so the thread tells which request it is.
thread_local const ExchangeScope::Answer* current = nullptr;

/// One call of the library's provider sends everything. A body that ends early must not look whole: saying false
/// makes the library drop the connection.
void fill_stream(httplib::Response& response, StreamBody body, const std::string& type, bool chunked) {
  const auto produce = [body](httplib::DataSink& sink) {
    return body.produce([&sink](std::string_view bytes) { return sink.write(bytes.data(), bytes.size()); });
  };
  if (body.length) {
    const std::uint64_t length = *body.length;
    response.set_content_provider(static_cast<std::size_t>(length), type,
                                  [produce, length](std::size_t offset, std::size_t left, httplib::DataSink& sink) {
                                    return offset == 0 && left == length && produce(sink);
                                  });
    return;
  }
  const auto provider = [produce](std::size_t, httplib::DataSink& sink) {
    if (!produce(sink)) return false;
    sink.done();
    return true;
  };
  if (chunked)
    response.set_chunked_content_provider(type, provider);
  else
    response.set_content_provider(type, provider);
}

class RehearsalStream : public httplib::Stream {
 public:
  bool is_readable() const override { return true; }
  bool is_writable() const override { return true; }
  ssize_t read(char* into, size_t size) override {
    const std::size_t n = std::min(size, request_.size());
    request_.copy(into, n);
    request_.remove_prefix(n);
    return static_cast<ssize_t>(n);
  }
  ssize_t write(const char*, size_t size) override { return static_cast<ssize_t>(size); }
  void get_remote_ip_and_port(std::string&, int&) const override {}
  void get_local_ip_and_port(std::string&, int&) const override {}
  socket_t socket() const override { return 0; }

 private:
  std::string_view request_ = "GET / HTTP/1.1\r\n\r\n";
};

}  // namespace

ExchangeScope::ExchangeScope(Answer answer) : answer_(std::move(answer)) { current = &answer_; }
ExchangeScope::~ExchangeScope() { current = nullptr; }

void install_exchange(httplib::Server& server) {
  server.set_pre_routing_handler([](const httplib::Request&, httplib::Response& response) {
    (*current)(response);
    return httplib::Server::HandlerResponse::Handled;
  });
  server.set_post_routing_handler([](const httplib::Request&, httplib::Response& response) {
    response.headers.erase("Keep-Alive");  // the library's own idea of it, not ours
    if (response.status == 204 || response.status == 304) response.headers.erase("Content-Length");
  });
}

void fill(httplib::Response& response, Reply reply, const RequestHead& head) {
  response.status = reply.status;
  for (const auto& [name, value] : reply.headers) response.set_header(name, value);
  response.set_header("X-Content-Type-Options", "nosniff");
  // The library would promise ranges on HEAD that the routes do not give.
  if (!find_header(reply.headers, "Accept-Ranges")) response.set_header("Accept-Ranges", "none");
  if (reply.stream && reply.stream->length.value_or(1) > 0)
    fill_stream(response, std::move(*reply.stream), reply.content_type, !head.http_1_0);
  else if (!reply.body.empty())
    response.set_content(reply.body, reply.content_type);
  else if (reply.lasting)
    response.set_header("Content-Type", reply.content_type);
}

void rehearse(const std::function<bool(httplib::Stream&)>& run) {
  RehearsalStream stream;
  const ExchangeScope scope([](httplib::Response& response) {
    Reply reply;
    reply.content_type = "text/plain";
    reply.stream = StreamBody{std::nullopt, [](const Writer& write) { return write("."); }};
    fill(response, std::move(reply), RequestHead{});
  });
  if (!run(stream)) throw io_error("cpp-httplib", "an exchange with nobody failed");
}

std::string lasting_head(const Reply& reply, bool chunked, bool keep) {
  std::string head = "HTTP/1.1 " + std::to_string(reply.status) + " OK\r\n";
  for (const auto& [name, value] : reply.headers) head += name + ": " + value + "\r\n";
  head += "Content-Type: " + reply.content_type + "\r\nX-Content-Type-Options: nosniff\r\n";
  if (chunked) head += "Transfer-Encoding: chunked\r\n";
  if (!keep) head += "Connection: close\r\n";
  return head + "\r\n";
}

std::string plain_refusal(const Problem& problem) {
  const std::string body = problem.body("").dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  return "HTTP/1.1 " + std::to_string(problem.status()) +
         " Refused\r\nContent-Type: application/problem+json\r\nConnection: close\r\nContent-Length: " +
         std::to_string(body.size()) + "\r\n\r\n" + body;
}

}  // namespace sheaf::server
