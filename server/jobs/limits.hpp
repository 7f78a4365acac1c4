// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace sheaf::server {

/// What one request or job may ask for. Passing one is answered with the limit and the value.
struct Limits {
  std::uint64_t upload_bytes = std::uint64_t{1} << 30;    // a whole request body
  std::uint64_t settings_bytes = std::uint64_t{1} << 20;  // the settings part
  std::uint64_t camera_bytes = std::uint64_t{16} << 20;   // the camera part
  std::uint64_t parts = 1024;                             // of a multipart body
  std::uint64_t unpacked_bytes = std::uint64_t{4} << 30;  // everything out of a .zip
  std::uint64_t zip_entries = 4096;
  std::uint64_t zip_ratio = 200;  // unpacked to packed; DEFLATE can reach 1032
  std::uint64_t frames = 10'000;
  std::uint64_t pixels = std::uint64_t{1} << 26;  // of a frame: 8192 × 8192
  std::uint64_t spp = 4096;
  std::uint64_t depth = 64;
  std::uint64_t memory_mib = 65'536;
  std::uint64_t triangles = 64'000'000;                  // of the whole scene, instances counted; 0: any
  std::uint64_t texture_bytes = std::uint64_t{4} << 30;  // of its images, decoded; 0: any
  std::uint64_t inspect_seconds = 60;                    // for loading a scene once, to know these two
  std::uint64_t queued_jobs = 1000;
  std::uint64_t log_bytes = std::uint64_t{4} << 20;  // kept of a worker's log
};

/// Limits of what a job's settings may ask for, by the names that the engine's table of settings has for them.
struct SettingLimit {
  const char* name;
  std::uint64_t Limits::*value;
  const char* of;
};
inline constexpr std::array<SettingLimit, 5> setting_limits{
    {{"max-frames", &Limits::frames, "frames of a job"},
     {"max-pixels", &Limits::pixels, "pixels of a frame"},
     {"max-spp", &Limits::spp, "samples per pixel"},
     {"max-depth", &Limits::depth, "generations of reflection and refraction"},
     {"max-memory", &Limits::memory_mib, "MiB of a job's memory budget"}}};

/// Null where the setting has none.
[[nodiscard]] constexpr const SettingLimit* find_limit(const char* name) {
  for (const SettingLimit& limit : setting_limits)
    if (name != nullptr && std::string_view(name) == limit.name) return &limit;
  return nullptr;
}

}  // namespace sheaf::server
