// SPDX-License-Identifier: MIT
// What a scene holds, before its job is taken: `sheaf inspect --json`, confined like any worker and for a bounded time,
// so that no untrusted scene is parsed in this process. Refuses a scene that exceeds a limit; the job of a scene that
// is bad in another way fails, with the worker's reason.
#pragma once

#include <atomic>
#include <condition_variable>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "jobs/confinement.hpp"
#include "jobs/limits.hpp"
#include "jobs/worker_process.hpp"

namespace sheaf::server {

class SceneInspector {
 public:
  /// `at_once` may run at a time, others wait.
  SceneInspector(std::string sheaf, ConfinementOptions confinement, Limits limits, std::size_t at_once)
      : sheaf_(std::move(sheaf)), confinement_(std::move(confinement)), limits_(limits), free_(at_once) {}

  /// `scene` lies in `folder`, an upload's own; `arguments` are those that its job will be rendered with. Throws
  /// Problem: 422 with the limit's name, the limit and the value; 503 once interrupted.
  void check(const std::filesystem::path& folder, const std::filesystem::path& scene,
             const std::vector<std::string>& arguments);

  /// Ends what runs and refuses what comes: the service stops.
  void interrupt();

 private:
  struct Inspection;
  using Slot = std::shared_ptr<void>;
  [[nodiscard]] Slot wait_for_slot();
  [[nodiscard]] Inspection inspect(const std::filesystem::path& folder, const std::filesystem::path& scene,
                                   const std::vector<std::string>& arguments) const;

  std::string sheaf_;
  ConfinementOptions confinement_;
  Limits limits_;
  StopSwitch stop_;
  std::mutex mutex_;
  std::condition_variable freed_;
  std::size_t free_;
};

}  // namespace sheaf::server
