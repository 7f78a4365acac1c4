// SPDX-License-Identifier: MIT
// What the filter of system calls refuses, asked of the kernel itself in a confined child.
#include <gtest/gtest.h>
#include <linux/io_uring.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/ptrace.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <functional>
#include <map>
#include <string>

#include "jobs/confinement.hpp"

namespace sheaf::server {
namespace {

int error_of(long result) { return result < 0 ? errno : 0; }

constexpr int unfiltered = 255;

/// What `attempt` gives in a process that is confined as a worker is.
int confined(const std::function<int()>& attempt) {
  const Confinement confinement({}, "/proc/self/exe", {});
  const pid_t child = ::fork();
  if (child == 0) ::_exit(confinement.apply() & Confinement::system_calls ? attempt() : unfiltered);
  int status = 0;
  EXPECT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status)) << status;
  return WEXITSTATUS(status);
}

long clone_with(unsigned long flags) {
  const long pid = ::syscall(SYS_clone, flags | SIGCHLD, nullptr, nullptr, nullptr, nullptr);
  if (pid == 0) ::_exit(0);
  return pid;
}

class SystemCallFilter : public testing::Test {
 protected:
  void SetUp() override {
    if (confined([] { return 0; }) == unfiltered) GTEST_SKIP() << "this kernel has no seccomp";
  }
};

TEST_F(SystemCallFilter, RefusesWhatOnlyDebuggersAndAdministratorsUse) {
  io_uring_params ring{};
  // Without the filter root may do most of these, and what nobody may do fails with another reason.
  const std::map<std::string, std::function<long()>> calls{
      {"socket", [] { return ::socket(AF_UNIX, SOCK_STREAM, 0); }},
      {"unshare", [] { return ::unshare(CLONE_NEWNS); }},
      {"ptrace", [] { return ::ptrace(PTRACE_TRACEME, 0, nullptr, nullptr); }},
      {"mount", [] { return ::mount(nullptr, nullptr, nullptr, 0, nullptr); }},
      {"chroot", [] { return ::chroot("/"); }},
      {"process_vm_readv", [] { return ::syscall(SYS_process_vm_readv, ::getpid(), nullptr, 0, nullptr, 0, 0); }},
      {"setns", [] { return ::syscall(SYS_setns, -1, 0); }},
      {"bpf", [] { return ::syscall(SYS_bpf, -1, nullptr, 0); }},
      {"keyctl", [] { return ::syscall(SYS_keyctl, -1, 0, 0, 0, 0); }},
      {"io_uring_setup", [&ring] { return ::syscall(SYS_io_uring_setup, 0, &ring); }},
      {"open_by_handle_at", [] { return ::syscall(SYS_open_by_handle_at, -1, nullptr, 0); }},
      {"quotactl", [] { return ::syscall(SYS_quotactl, -1, nullptr, 0, nullptr); }}};
  for (const auto& [name, call] : calls)
    EXPECT_EQ(confined([&call = call] { return error_of(call()); }), EPERM) << name;
}

TEST_F(SystemCallFilter, LetsProcessesBeMadeButNoNamespaces) {
  for (const unsigned long flag : {CLONE_NEWUSER, CLONE_NEWNS, CLONE_NEWNET, CLONE_NEWPID})
    for (const unsigned long others : {0ul, 0ul + CLONE_FS, 0ul + CLONE_NEWUTS})
      EXPECT_EQ(confined([=] { return error_of(clone_with(flag | others)); }), EPERM) << flag << " " << others;
  EXPECT_EQ(confined([] { return error_of(clone_with(0)); }), 0);
  // The flags of clone3 lie in memory, out of a filter's reach; a C library that hears ENOSYS goes on with clone.
  EXPECT_EQ(confined([] { return error_of(::syscall(SYS_clone3, nullptr, 0)); }), ENOSYS);
}

#if defined(__x86_64__)
TEST_F(SystemCallFilter, RefusesTheNumbersOfOtherArchitectures) {
  constexpr long x32_getpid = 0x40000000 + 39;
  EXPECT_EQ(confined([] { return error_of(::syscall(x32_getpid)); }), EPERM);
  EXPECT_EQ(confined([] {
              long result = 20;  // getpid of i386
              asm volatile("int $0x80" : "+a"(result) : : "memory");
              return static_cast<int>(-result);
            }),
            EPERM);
}
#endif

}  // namespace
}  // namespace sheaf::server
