// SPDX-License-Identifier: MIT
// A data folder has one service: as long as that lives, and no longer.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <filesystem>

#include "core/error.hpp"
#include "jobs/job_files.hpp"

namespace sheaf::server {
namespace {

class DataFolderLock : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (std::filesystem::temp_directory_path() / "sheaf-files-XXXXXX").string();
    ASSERT_TRUE(::mkdtemp(pattern.data()));
    data_ = pattern;
    ASSERT_EQ(::pipe(ready_.data()), 0);
    ASSERT_EQ(::pipe(end_.data()), 0);
  }
  void TearDown() override {
    for (const int fd : {ready_[0], ready_[1], end_[0], end_[1]}) ::close(fd);
    std::filesystem::remove_all(data_);
  }

  /// A process that uses the folder, and has a child which holds all that it has open, as one does before its exec.
  /// Both stay until the test's end.
  pid_t start_service() {
    const pid_t pid = ::fork();
    if (pid != 0) return pid;
    ::close(end_[1]);
    try {
      const JobFiles files(data_);
      const bool parent = ::fork() != 0;
      char byte = 'r';
      if (parent && ::write(ready_[1], &byte, 1) != 1) ::_exit(1);
      while (::read(end_[0], &byte, 1) > 0) {
      }
    } catch (...) {
      ::_exit(1);
    }
    ::_exit(0);
  }

  std::filesystem::path data_;
  std::array<int, 2> ready_{}, end_{};
};

TEST_F(DataFolderLock, GoesWithItsProcessAndNotWithItsChildren) {
  const pid_t service = start_service();
  char byte = 0;
  ASSERT_EQ(::read(ready_[0], &byte, 1), 1);
  EXPECT_THROW(JobFiles{data_}, Error);
  ASSERT_EQ(::kill(service, SIGKILL), 0);
  ASSERT_EQ(::waitpid(service, nullptr, 0), service);
  EXPECT_NO_THROW(JobFiles{data_});
}

}  // namespace
}  // namespace sheaf::server
