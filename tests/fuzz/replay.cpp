// SPDX-License-Identifier: MIT
// Runs a fuzz target over files and folders of files, with any compiler: what fuzzing once found stays found.
#include <chrono>
#include <fstream>
#include <iterator>
#include <vector>

#include "target.hpp"

namespace {

using Clock = std::chrono::steady_clock;
constexpr auto slow = std::chrono::seconds(10);  // even with sanitizers, on a busy machine

bool replay(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes(std::istreambuf_iterator<char>(file), {});
  std::vector<std::uint8_t> exact(bytes.begin(), bytes.end());  // no byte behind its end
  const auto begun = Clock::now();
  LLVMFuzzerTestOneInput(exact.data(), exact.size());
  if (Clock::now() - begun < slow) return true;
  std::fprintf(stderr, "%s: took more than 10 s\n", path.c_str());
  return false;
}

}  // namespace

int main(int argc, char** argv) {
  std::size_t count = 0;
  bool well = true;
  for (int i = 1; i < argc; ++i) {
    if (!std::filesystem::is_directory(argv[i])) {
      well = replay(argv[i]) && well, ++count;
      continue;
    }
    for (const auto& entry : std::filesystem::directory_iterator(argv[i]))
      if (entry.is_regular_file()) well = replay(entry.path()) && well, ++count;
  }
  std::printf("%zu inputs\n", count);
  return well && count > 0 ? 0 : 1;
}
