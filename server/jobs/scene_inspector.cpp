// SPDX-License-Identifier: MIT
#include "jobs/scene_inspector.hpp"

#include <algorithm>
#include <csignal>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/error.hpp"
#include "util/problem.hpp"

namespace sheaf::server {
namespace {

constexpr std::size_t max_output = std::size_t{1} << 20;  // facts are a few KB; names in a scene may make them longer
constexpr int exit_limit = 5;                             // `sheaf`: a limit was exceeded

void check_limit(const nlohmann::json& facts, const char* fact, const char* name, std::uint64_t limit,
                 const std::string& what) {
  const auto found = facts.find(fact);
  if (limit == 0 || found == facts.end() || !found->is_number_unsigned()) return;
  const auto value = found->get<std::uint64_t>();
  if (value <= limit) return;
  throw Problem(ProblemKind::limit_exceeded,
                "scene: " + std::to_string(value) + " " + what + ", the limit is " + std::to_string(limit))
      .exceeded(name, limit, value);
}

[[noreturn]] void refuse_stopping() {
  throw Problem(ProblemKind::shutting_down, "no new job is taken").header("Retry-After", "5");
}

std::string error_line(const std::string& log) {
  const auto end = std::min(log.find('\n'), log.size());
  return log.substr(0, std::min<std::size_t>(end, 1000));
}

}  // namespace

struct SceneInspector::Inspection {
  WorkerEnding ending;
  std::string text, log;  // what it printed; of stderr the beginning
};

SceneInspector::Inspection SceneInspector::inspect(const std::filesystem::path& folder,
                                                   const std::filesystem::path& scene,
                                                   const std::vector<std::string>& arguments) const {
  ConfinementOptions options = confinement_;
  options.cpu_seconds = std::min<std::uint64_t>(options.cpu_seconds, limits_.inspect_seconds * 8);  // images: 8 threads
  const Confinement confinement(options, sheaf_, folder);
  Inspection found;
  const WorkerOutput output{[&](std::string_view line) {
                              if (found.text.size() < max_output) found.text.append(line).append("\n");
                            },
                            [&](std::string_view bytes) {
                              if (found.log.size() < max_output) found.log.append(bytes);
                            }};
  const std::chrono::seconds wall(limits_.inspect_seconds);
  std::vector<std::string> command{sheaf_, "inspect", scene.string(), "--json"};
  std::ranges::copy_if(arguments, std::back_inserter(command), [](const std::string& argument) {
    return argument.starts_with("--scene-name=") || argument.starts_with("--variant=");
  });
  found.ending = run_worker(command, output, stop_, {std::chrono::milliseconds(0), wall, &confinement});
  return found;
}

/// The slot is free again when the result is destroyed.
SceneInspector::Slot SceneInspector::wait_for_slot() {
  std::unique_lock lock(mutex_);
  freed_.wait(lock, [this] { return free_ > 0 || stop_.asked(); });
  if (stop_.asked()) refuse_stopping();
  --free_;
  return {this, [this](void*) {
            {
              const std::lock_guard again(mutex_);
              ++free_;
            }
            freed_.notify_one();
          }};
}

void SceneInspector::check(const std::filesystem::path& folder, const std::filesystem::path& scene,
                           const std::vector<std::string>& arguments) {
  if (limits_.triangles == 0 && limits_.texture_bytes == 0) return;
  const Slot slot = wait_for_slot();
  Inspection found;
  try {
    found = inspect(folder, scene, arguments);
  } catch (const Error&) {
    return;  // it cannot be started: the job will fail with that reason
  }
  if (stop_.asked()) refuse_stopping();

  if (found.ending.timed_out || found.ending.signal == SIGXCPU)
    throw Problem(ProblemKind::limit_exceeded, "scene: takes more than " + std::to_string(limits_.inspect_seconds) +
                                                   " s to load, which is the limit")
        .exceeded("max-inspect", limits_.inspect_seconds, limits_.inspect_seconds + 1);
  if (found.ending.exit_code == exit_limit) {
    std::string reason = error_line(found.log);
    const std::string hidden = folder.string() + "/";
    for (auto at = reason.find(hidden); at != std::string::npos; at = reason.find(hidden, at))
      reason.erase(at, hidden.size());
    throw Problem(ProblemKind::limit_exceeded, reason);
  }
  const auto facts = nlohmann::json::parse(found.text, nullptr, false);
  if (found.ending.exit_code != 0 || !facts.is_object()) return;
  check_limit(facts, "triangles", "max-triangles", limits_.triangles, "triangles");
  check_limit(facts, "texture_bytes", "max-textures", limits_.texture_bytes, "bytes of decoded images");
}

void SceneInspector::interrupt() {
  {
    const std::lock_guard lock(mutex_);
    stop_.force();
  }
  freed_.notify_all();
}

}  // namespace sheaf::server
