// SPDX-License-Identifier: MIT
#include "jobs/system_call_filter.hpp"

#include <linux/seccomp.h>
#include <sched.h>
#include <seccomp.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <memory>

#include "util/fd.hpp"

namespace sheaf::server {
namespace {

constexpr int refused_calls[] = {SCMP_SYS(ptrace),
                                 SCMP_SYS(process_vm_readv),
                                 SCMP_SYS(process_vm_writev),
                                 SCMP_SYS(mount),
                                 SCMP_SYS(umount2),
                                 SCMP_SYS(pivot_root),
                                 SCMP_SYS(chroot),
                                 SCMP_SYS(setns),
                                 SCMP_SYS(unshare),
                                 SCMP_SYS(bpf),
                                 SCMP_SYS(perf_event_open),
                                 SCMP_SYS(kexec_load),
                                 SCMP_SYS(init_module),
                                 SCMP_SYS(finit_module),
                                 SCMP_SYS(delete_module),
                                 SCMP_SYS(keyctl),
                                 SCMP_SYS(add_key),
                                 SCMP_SYS(request_key),
                                 SCMP_SYS(userfaultfd),
                                 SCMP_SYS(io_uring_setup),
                                 SCMP_SYS(reboot),
                                 SCMP_SYS(swapon),
                                 SCMP_SYS(swapoff),
                                 SCMP_SYS(settimeofday),
                                 SCMP_SYS(clock_settime),
                                 SCMP_SYS(open_by_handle_at),
                                 SCMP_SYS(quotactl),
                                 SCMP_SYS(acct),
                                 SCMP_SYS(socket)};
constexpr scmp_datum_t refused_clone_flags[] = {CLONE_NEWUSER, CLONE_NEWNS, CLONE_NEWNET, CLONE_NEWPID};

/// True if all rules are in `filter`. A refused call fails with EPERM, as it does for an unprivileged program.
bool add_rules(scmp_filter_ctx filter) {
  constexpr std::uint32_t refuse = SCMP_ACT_ERRNO(EPERM);
  // Call numbers of another architecture (i386, x32) mean other calls.
  bool added = ::seccomp_attr_set(filter, SCMP_FLTATR_ACT_BADARCH, refuse) == 0;
  for (const int call : refused_calls) added &= ::seccomp_rule_add(filter, refuse, call, 0) == 0;
  for (const scmp_datum_t flag : refused_clone_flags)
    added &= ::seccomp_rule_add(filter, refuse, SCMP_SYS(clone), 1, SCMP_A0_64(SCMP_CMP_MASKED_EQ, flag, flag)) == 0;
  // The flags of clone3 are in memory, where a filter cannot read them. A C library that gets ENOSYS uses clone.
  return added && ::seccomp_rule_add(filter, SCMP_ACT_ERRNO(ENOSYS), SCMP_SYS(clone3), 0) == 0;
}

/// The filter's instructions, through a file in memory: seccomp_export_bpf_mem is newer than Debian 12's libseccomp.
std::vector<sock_filter> exported(scmp_filter_ctx filter) {
  const Fd file(::memfd_create("seccomp", MFD_CLOEXEC));
  struct stat info {};
  if (!file.valid() || ::seccomp_export_bpf(filter, file.get()) != 0 || ::fstat(file.get(), &info) != 0) return {};
  std::vector<sock_filter> program(static_cast<std::size_t>(info.st_size) / sizeof(sock_filter));
  if (::pread(file.get(), program.data(), program.size() * sizeof(sock_filter), 0) != info.st_size) return {};
  return program;
}

}  // namespace

SystemCallFilter::SystemCallFilter() {
  const std::unique_ptr<void, decltype(&::seccomp_release)> filter(::seccomp_init(SCMP_ACT_ALLOW), &::seccomp_release);
  if (filter && add_rules(filter.get())) program_ = exported(filter.get());
}

bool SystemCallFilter::install() const noexcept {
  if (program_.empty()) return false;
  const sock_fprog program{static_cast<unsigned short>(program_.size()), const_cast<sock_filter*>(program_.data())};
  return ::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program, 0, 0) == 0;
}

}  // namespace sheaf::server
