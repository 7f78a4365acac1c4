// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <string>

#include "http/http_server.hpp"
#include "jobs/job_service.hpp"

namespace sheaf::server {

struct ProgramOptions {
  std::string host = "127.0.0.1", port = "8080";
  std::string data;        // empty: a folder of its own, removed at the end
  std::string port_file;   // empty: none
  std::string token_file;  // empty: none
  std::string report;      // of sheaf-client report, to be shown; empty: none
  std::string new_token;   // to be made and printed instead of serving
  bool anonymous = false;  // listens beyond loopback without tokens
  std::size_t streams = 2000;
  std::chrono::milliseconds heartbeat{15'000};
  HttpOptions http;
  ServiceOptions service;
};

/// The command line. Throws Error{usage}. `help` receives the text of --help or --version; then the program ends.
[[nodiscard]] ProgramOptions parse_options(int argc, const char* const* argv, std::string& help);

/// "host:port", "[v6]:port", ":port". Throws Error{usage}.
void split_address(const std::string& text, std::string& host, std::string& port);

}  // namespace sheaf::server
