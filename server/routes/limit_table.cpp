// SPDX-License-Identifier: MIT
#include "routes/limit_table.hpp"

namespace sheaf::server {

nlohmann::ordered_json limit_table(const ServiceOptions& options) {
  const Limits& limits = options.limits;
  const RunnerOptions& runner = options.runner;
  nlohmann::ordered_json table = nlohmann::ordered_json::object();
  const auto add = [&table](const char* name, std::uint64_t value, const char* what, const char* answer) {
    table[name] = {{"limit", value}, {"of", what}, {"answer", answer}};
  };
  constexpr const char* upload = "413 too-large";
  add("max-upload", limits.upload_bytes, "bytes of a whole request", upload);
  add("max-parts", limits.parts, "parts of a multipart body", upload);
  add("settings", limits.settings_bytes, "bytes of the settings part", upload);
  add("camera", limits.camera_bytes, "bytes of the camera part", upload);
  add("max-unpacked", limits.unpacked_bytes, "bytes out of a .zip", upload);
  add("max-zip-entries", limits.zip_entries, "entries of a .zip", upload);
  add("max-zip-ratio", limits.zip_ratio, "unpacked to packed size", upload);

  constexpr const char* job = "422 limit-exceeded";
  for (const SettingLimit& limit : setting_limits) add(limit.name, limits.*limit.value, limit.of, job);
  if (limits.triangles > 0) add("max-triangles", limits.triangles, "triangles of a scene, instances counted", job);
  if (limits.texture_bytes > 0) add("max-textures", limits.texture_bytes, "bytes of a scene's decoded images", job);
  add("max-inspect", limits.inspect_seconds, "seconds for loading a scene", job);

  constexpr const char* ends = "the job fails: limit-exceeded";
  add("max-cpu", runner.confinement.cpu_seconds, "seconds of processor time of a worker", ends);
  add("max-wall", static_cast<std::uint64_t>(runner.wall.count()), "seconds that a worker may run", ends);
  add("worker-memory", runner.confinement.memory_bytes, "bytes of private memory of a worker", "the job fails");
  add("max-file", runner.confinement.file_bytes, "bytes of one file that a worker writes", "the job fails");

  constexpr const char* later = "503 with Retry-After";
  add("max-queue", limits.queued_jobs, "jobs that wait", later);
  add("min-free", options.min_free_bytes, "bytes of free disk, at least", later);
  return table;
}

}  // namespace sheaf::server
