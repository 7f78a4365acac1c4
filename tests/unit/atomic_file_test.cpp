// SPDX-License-Identifier: MIT
#include "output/atomic_file.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <array>
#include <csignal>
#include <future>

#include "output_support.hpp"

namespace sheaf {
namespace {

using test::contents;
using test::error_of;
using test::put;
using test::status_in_child;

class AtomicFileTest : public test::OutputTest {
 protected:
  // A process that dies between writing and renaming.
  void die_while_writing(const std::string& name) const {
    const int status = status_in_child([&] {
      const std::string big(3 << 20, 'x');
      AtomicFile file(path(name));
      file.write(std::as_bytes(std::span(big)));
      raise(SIGKILL);
    });
    ASSERT_TRUE(WIFSIGNALED(status));
  }
};

using Names = std::vector<std::string>;

TEST_F(AtomicFileTest, AppearsWhole) {
  write_file_atomically(path("a.txt"), std::string("hello"));
  EXPECT_EQ(contents(path("a.txt")), "hello");
  EXPECT_EQ(names(), Names{"a.txt"});
}

TEST_F(AtomicFileTest, IsInvisibleUnderItsNameUntilCommitted) {
  put(path("a.txt"), "old");
  AtomicFile file(path("a.txt"));
  file.write(std::as_bytes(std::span(std::string_view("new"))));
  EXPECT_EQ(contents(path("a.txt")), "old");
  EXPECT_EQ(names(), (Names{".a.txt." + std::to_string(getpid()) + ".part", "a.txt"}));
  file.commit();
  EXPECT_EQ(contents(path("a.txt")), "new");
  EXPECT_EQ(names(), Names{"a.txt"});
}

TEST_F(AtomicFileTest, LeavesNothingWithoutCommit) {
  { AtomicFile(path("a")).write(std::as_bytes(std::span(std::string_view("x")))); }
  EXPECT_EQ(names(), Names{});
}

TEST_F(AtomicFileTest, SeeksBackAsChunkTablesNeed) {
  AtomicFile file(path("a"));
  const auto write = [&](std::string_view text) { file.write(std::as_bytes(std::span(text))); };
  write("0000rest");
  EXPECT_EQ(file.tell(), 8u);
  file.seek(1);
  write("12");
  EXPECT_EQ(file.tell(), 3u);
  file.commit();
  EXPECT_EQ(contents(path("a")), "0120rest");
}

TEST_F(AtomicFileTest, KeepsBytesAcrossItsBuffer) {
  std::string big(5'000'001, ' ');
  for (std::size_t i = 0; i < big.size(); ++i) big[i] = static_cast<char>(i * 31 >> 3);
  AtomicFile file(path("a"));
  for (std::size_t at = 0; at < big.size(); at += 7777)
    file.write(std::as_bytes(std::span(big).subspan(at, std::min<std::size_t>(7777, big.size() - at))));
  file.commit();
  EXPECT_EQ(contents(path("a")), big);
}

TEST_F(AtomicFileTest, LinkStaysAndItsEndIsReplaced) {
  std::filesystem::create_directory(path("far"));
  put(path("far/file"), "old");
  std::filesystem::create_symlink("far/file", path("near"));
  std::filesystem::create_symlink(path("near"), path("link"));
  {
    AtomicFile file(path("link"));
    file.write(std::as_bytes(std::span(std::string_view("new"))));
    EXPECT_EQ(contents(path("far/file")), "old");
    file.commit();
  }
  EXPECT_EQ(std::filesystem::read_symlink(path("link")), path("near"));
  EXPECT_EQ(std::filesystem::read_symlink(path("near")), "far/file");
  EXPECT_FALSE(std::filesystem::is_symlink(path("far/file")));
  EXPECT_EQ(contents(path("far/file")), "new");
  EXPECT_EQ(names(), (Names{"far", "link", "near"}));
}

TEST_F(AtomicFileTest, DanglingLinkGetsItsFileAndALoopIsNamed) {
  std::filesystem::create_symlink("later", path("link"));
  write_file_atomically(path("link"), std::string("x"));
  EXPECT_TRUE(std::filesystem::is_symlink(path("link")));
  EXPECT_EQ(contents(path("later")), "x");
  std::filesystem::create_symlink("no/later", path("lost"));
  EXPECT_EQ(error_of(ErrorKind::io, [&] { write_file_atomically(path("lost"), std::string("x")); }),
            path("lost") + ": cannot create: No such file or directory");
  EXPECT_TRUE(std::filesystem::is_symlink(path("lost")));
}

TEST_F(AtomicFileTest, FifoGetsTheWholeFileOnceCommitted) {
  ASSERT_EQ(mkfifo(path("fifo").c_str(), 0600), 0);
  std::filesystem::create_symlink("fifo", path("link"));
  for (const char* name : {"fifo", "link"}) {
    auto reader = std::async(std::launch::async, [&] { return contents(path("fifo")); });
    {
      AtomicFile file(path(name));
      const auto write = [&](std::string_view text) { file.write(std::as_bytes(std::span(text))); };
      write("0000rest");
      file.seek(1);  // as chunk tables need
      write("12");
      file.commit();
      EXPECT_THROW(write("more"), Error);
    }
    EXPECT_EQ(reader.get(), "0120rest");
  }
  struct stat status {};
  ASSERT_EQ(lstat(path("fifo").c_str(), &status), 0);
  EXPECT_TRUE(S_ISFIFO(status.st_mode));
  EXPECT_EQ(names(), (Names{"fifo", "link"}));
}

TEST_F(AtomicFileTest, ReaderThatGoesAwayIsAnErrorAndNoSignal) {
  std::array<int, 2> pipe_ends{};
  ASSERT_EQ(pipe(pipe_ends.data()), 0);
  close(pipe_ends[0]);
  const std::string at = "/dev/fd/" + std::to_string(pipe_ends[1]);
  EXPECT_EQ(error_of(ErrorKind::io, [&] { write_file_atomically(at, std::string("x")); }),
            at + ": cannot write: Broken pipe");
  close(pipe_ends[1]);
}

TEST_F(AtomicFileTest, OpenDescriptorIsWrittenWhereItStands) {
  const int descriptor = open(path("log").c_str(), O_RDWR | O_CREAT, 0600);
  ASSERT_EQ(write(descriptor, "first ", 6), 6);
  write_file_atomically("/dev/fd/" + std::to_string(descriptor), std::string("second "));
  ASSERT_EQ(write(descriptor, "third", 5), 5);
  close(descriptor);
  EXPECT_EQ(contents(path("log")), "first second third");
  EXPECT_EQ(names(), Names{"log"});
}

TEST_F(AtomicFileTest, TwoWritersOfOneNameDoNotMix) {
  AtomicFile first(path("a")), second(path("a"));
  EXPECT_NE(first.temporary_path(), second.temporary_path());
  first.write(std::as_bytes(std::span(std::string_view("first"))));
  second.write(std::as_bytes(std::span(std::string_view("second"))));
  second.commit();
  EXPECT_EQ(contents(path("a")), "second");
  first.commit();
  EXPECT_EQ(contents(path("a")), "first");
  EXPECT_EQ(names(), Names{"a"});
}

TEST_F(AtomicFileTest, KilledWriterLeavesNoNamedFileAndItsPartGoes) {
  put(path("kept.part"), "");
  put(path(".notes.part"), "");
  put(path(".a.exr.x12.part"), "");
  die_while_writing("a.exr");
  EXPECT_FALSE(std::filesystem::exists(path("a.exr")));
  ASSERT_EQ(names().size(), 4u);
  AtomicFile running(path("b.exr"));
  EXPECT_EQ(remove_stale_parts(folder_), 1u);
  const std::string part = std::filesystem::path(running.temporary_path()).filename().string();
  EXPECT_EQ(names(), (Names{".a.exr.x12.part", part, ".notes.part", "kept.part"}));
  running.commit();
  EXPECT_TRUE(std::filesystem::exists(path("b.exr")));
}

TEST_F(AtomicFileTest, LeftoverOfAReusedProcessIdIsReplaced) {
  put(path(".a." + std::to_string(getpid()) + ".part"), "much longer than what comes now");
  write_file_atomically(path("a"), std::string("short"));
  EXPECT_EQ(contents(path("a")), "short");
  EXPECT_EQ(names(), Names{"a"});
}

TEST_F(AtomicFileTest, StaleLinksAndFoldersAreLeftAlone) {
  std::filesystem::create_directory(path(".a.999999.part"));
  std::filesystem::create_symlink(path("elsewhere"), path(".b.999999.part"));
  mkfifo(path(".c.999999.part").c_str(), 0600);
  EXPECT_EQ(remove_stale_parts(folder_), 0u);
  EXPECT_EQ(names().size(), 3u);
}

TEST_F(AtomicFileTest, FullDiskIsNamedAndSticks) {
  // A file size limit stands in for a full disk: writing fails half-way with an errno.
  const int status = status_in_child([&] {
    signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{1 << 20, 1 << 20};
    setrlimit(RLIMIT_FSIZE, &limit);
    AtomicFile file(path("a"));
    const std::string big(4 << 20, 'x');
    const std::string text = error_of(ErrorKind::io, [&] { file.write(std::as_bytes(std::span(big))); });
    const bool right = text == path("a") + ": cannot write: File too large";
    const std::string again = error_of(ErrorKind::io, [&] { file.commit(); });
    _exit(right && again == text && names().empty() ? 0 : 1);
  });
  EXPECT_EQ(status, 0);
  EXPECT_EQ(names(), Names{});
}

TEST_F(AtomicFileTest, NoPermissionIsNamed) {
  const int status = status_in_child([&] {
    chmod(folder_.c_str(), 0555);
    if (geteuid() == 0 && seteuid(65534) != 0) _exit(2);
    const std::string text = error_of(ErrorKind::io, [&] { write_file_atomically(path("a"), std::string("x")); });
    _exit(text == path("a") + ": cannot create: Permission denied" ? 0 : 1);
  });
  chmod(folder_.c_str(), 0755);
  EXPECT_EQ(status, 0);
}

TEST_F(AtomicFileTest, UnwritablePlacesAreNamed) {
  const auto failing = [](const std::string& at) {
    return error_of(ErrorKind::io, [&] { write_file_atomically(at, std::string("x")); });
  };
  EXPECT_EQ(failing(path("no/a")), path("no/a") + ": cannot create: No such file or directory");
  EXPECT_EQ(failing(folder_ + "/"), folder_ + "/: cannot create: Is a directory");
  EXPECT_EQ(failing(""), ": cannot create: Is a directory");
  std::filesystem::create_directory(path("d"));
  EXPECT_EQ(failing(path("d")), path("d") + ": cannot rename into place: Is a directory");
  EXPECT_EQ(names(), Names{"d"});
  EXPECT_EQ(error_of(ErrorKind::io, [&] { remove_stale_parts(path("no")); }),
            path("no") + ": cannot read the directory: No such file or directory");
}

}  // namespace
}  // namespace sheaf
