// SPDX-License-Identifier: MIT
#include "jobs/confinement.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>

#include "jobs/landlock.hpp"

namespace sheaf::server {
namespace {

namespace fs = std::filesystem;

constexpr rlim_t open_files = 1024;

// What programs and drivers need to read. Not /home, /root, /tmp, /var or all of /etc.
constexpr const char* system_paths[] = {"/usr",
                                        "/lib",
                                        "/lib32",
                                        "/lib64",
                                        "/bin",
                                        "/sbin",
                                        "/opt",
                                        "/nix/store",
                                        "/proc",
                                        "/sys",
                                        "/etc/alternatives",
                                        "/etc/drirc",
                                        "/etc/glvnd",
                                        "/etc/ld.so.cache",
                                        "/etc/ld.so.preload",
                                        "/etc/localtime",
                                        "/etc/nsswitch.conf",
                                        "/etc/nvidia",
                                        "/etc/passwd",
                                        "/etc/vulkan",
                                        "/run/opengl-driver"};
constexpr const char* path_variables[] = {"LD_LIBRARY_PATH", "VK_DRIVER_FILES", "VK_ICD_FILENAMES", "VK_LAYER_PATH",
                                          "PYTHONPATH"};

std::string environment(const char* name) {
  const char* const value = std::getenv(name);
  return value ? value : "";
}

/// Folders where drivers keep compiled shaders, and where the engine has them keep those of other widths
/// (kernel_cache_folder() in engine/vulkan/vector_width.hpp); made here, since a worker may not make them.
std::vector<std::string> cache_folders() {
  const std::string home = environment("HOME"), xdg = environment("XDG_CACHE_HOME"),
                    mesa = environment("MESA_SHADER_CACHE_DIR");
  const std::string cache = !xdg.empty() ? xdg : home.empty() ? "" : home + "/.cache";
  std::vector<std::string> folders;
  if (!mesa.empty()) folders.push_back(mesa);
  for (const char* name : {"mesa_shader_cache", "mesa_shader_cache_db", "sheaf", "nvidia"})
    if (mesa.empty() && !cache.empty()) folders.push_back(cache + "/" + name);
  if (!home.empty()) folders.push_back(home + "/.nv");
  for (const std::string& folder : folders) {
    std::error_code ignored;
    if (!folder.ends_with(".nv") && !folder.ends_with("nvidia")) fs::create_directories(folder, ignored);
  }
  return folders;
}

std::vector<std::string> listed_in(const std::string& text) {
  std::vector<std::string> paths;
  for (std::size_t at = 0; at < text.size();) {
    const auto end = std::min(text.find(':', at), text.size());
    if (end > at) paths.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return paths;
}

Fd ruleset_for(const ConfinementOptions& options, const std::string& program, const fs::path& folder) {
  FileRules rules;
  if (!rules.available()) return {};
  for (const char* path : system_paths) rules.allow_reading(path);
  for (const char* variable : path_variables)
    for (const std::string& path : listed_in(environment(variable))) rules.allow_reading(path);
  for (const std::string& path : options.readable) rules.allow_reading(path);
  std::error_code error;
  const fs::path real = fs::canonical(program, error);
  if (!error) rules.allow_reading(real.parent_path().string());
  rules.allow_writing("/dev");
  for (const std::string& path : cache_folders()) rules.allow_writing(path);
  if (!folder.empty()) rules.allow_writing(folder.string());
  return rules.take();
}

bool limit(__rlimit_resource resource, rlim_t soft, rlim_t hard) {
  rlimit now{};
  if (::getrlimit(resource, &now) != 0) return false;
  const rlim_t most = now.rlim_max < hard ? now.rlim_max : hard;
  const rlimit wanted{soft < most ? soft : most, most};
  return ::setrlimit(resource, &wanted) == 0;
}

/// It is the same for all workers.
const SystemCallFilter& shared_filter() {
  static const SystemCallFilter filter;
  return filter;
}

}  // namespace

Confinement::Confinement(const ConfinementOptions& options, const std::string& program, const fs::path& folder)
    : options_(options),
      ruleset_(options.on ? ruleset_for(options, program, folder) : Fd()),
      filter_(&shared_filter()) {}

unsigned Confinement::apply() const noexcept {
  unsigned held = 0;
  if (::nice(options_.nice) == -1) {
    // -1 may also be the new niceness; either way the worker runs.
  }
  // SIGXCPU tells the reason; SIGKILL follows for a worker that ignores it.
  const std::array set{limit(RLIMIT_CORE, 0, 0), limit(RLIMIT_DATA, options_.memory_bytes, options_.memory_bytes),
                       limit(RLIMIT_CPU, options_.cpu_seconds, options_.cpu_seconds + 5),
                       limit(RLIMIT_FSIZE, options_.file_bytes, options_.file_bytes),
                       limit(RLIMIT_NOFILE, open_files, open_files)};  // all are tried even if one fails
  if (std::find(set.begin(), set.end(), false) == set.end()) held |= limits;
  if (!options_.on) return held;
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0) held |= no_new_privileges;
  if (ruleset_.valid() && FileRules::enforce(ruleset_.get())) held |= files;
  if (filter_->install()) held |= system_calls;
  return held;
}

std::vector<std::string> all_measures() { return {"rlimits", "no_new_privs", "landlock", "seccomp"}; }

std::vector<std::string> active_measures(const ConfinementOptions& options) {
  const Confinement confinement(options, "/proc/self/exe", {});
  const pid_t child = ::fork();
  if (child == 0) ::_exit(static_cast<int>(confinement.apply()));
  int status = 0;
  while (child > 0 && ::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  const unsigned held = child > 0 && WIFEXITED(status) ? static_cast<unsigned>(WEXITSTATUS(status)) : 0;
  std::vector<std::string> names = all_measures(), active;
  for (std::size_t i = 0; i < names.size(); ++i)
    if (held & 1u << i) active.push_back(names[i]);
  return active;
}

}  // namespace sheaf::server
