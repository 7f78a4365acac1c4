// SPDX-License-Identifier: MIT
// What the tests of engine/output share: a folder that goes away, file contents, the text of an expected error.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "core/error.hpp"

namespace sheaf::test {

class OutputTest : public ::testing::Test {
 protected:
  OutputTest() {
    std::string pattern = (std::filesystem::temp_directory_path() / "sheaf-XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
  }
  ~OutputTest() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::string path(const std::string& name) const { return folder_ + "/" + name; }
  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> found;
    for (const auto& entry : std::filesystem::directory_iterator(folder_))
      found.push_back(entry.path().filename().string());
    std::sort(found.begin(), found.end());
    return found;
  }

  std::string folder_;
};

inline std::string contents(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

inline void put(const std::string& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

/// Runs `action` and hands back its Error's text, checking the kind; empty if it did not throw.
template <typename Action>
std::string error_of(ErrorKind kind, Action action) {
  try {
    action();
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_code(), static_cast<int>(kind));
    return error.what();
  }
  ADD_FAILURE() << "no error";
  return {};
}

/// Runs `action` in a child process, for what would change this one; its wait status.
template <typename Action>
int status_in_child(Action action) {
  const pid_t child = fork();
  if (child == 0) {
    action();
    _exit(0);
  }
  int status = -1;
  waitpid(child, &status, 0);
  return status;
}

}  // namespace sheaf::test
