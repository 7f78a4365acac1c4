// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string>

#include "program/options.hpp"

namespace sheaf::server {

/// The whole service, put together: store, files, workers, routes, connections.
class Service {
 public:
  /// Throws Error{io}: the data folder cannot be used.
  explicit Service(const ProgramOptions& options);
  ~Service();
  Service(const Service&) = delete;
  Service& operator=(const Service&) = delete;

  /// Returns the bound address; throws Error{io}.
  std::string bind();
  void run();   // until stop()
  void stop();  // from another thread; stops workers and ends event streams
  [[nodiscard]] std::vector<std::string> routes() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace sheaf::server
