// SPDX-License-Identifier: MIT
// What every fuzz target is: one function that takes any bytes at all. It may throw nothing, crash nowhere, and must
// come to an end soon; libFuzzer (or replay.cpp, with any compiler) calls it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace sheaf::fuzz {

inline std::string_view as_text(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// A folder of this process's own, in memory where the machine has such a place; gone at the end.
class Scratch {
 public:
  Scratch() {
    const bool shared_memory = std::filesystem::is_directory("/dev/shm");
    std::string pattern =
        ((shared_memory ? "/dev/shm" : std::filesystem::temp_directory_path()) / "sheaf-fuzz-XXXXXX").string();
    if (!::mkdtemp(pattern.data())) std::abort();
    path_ = pattern;
  }
  ~Scratch() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::string file(const char* name, std::string_view bytes) const {
    const std::filesystem::path place = path_ / name;
    std::ofstream(place, std::ios::binary | std::ios::trunc)
        .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return place.string();
  }

 private:
  std::filesystem::path path_;
};

/// A promise that was broken: as good as a crash.
inline void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "broken: %s\n", what);
  std::abort();
}

}  // namespace sheaf::fuzz
