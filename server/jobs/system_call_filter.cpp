// SPDX-License-Identifier: MIT
#include "jobs/system_call_filter.hpp"

#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/syscall.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>

namespace sheaf::server {
namespace {

#if defined(__x86_64__)
constexpr std::uint32_t architecture = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr std::uint32_t architecture = AUDIT_ARCH_AARCH64;
#else
constexpr std::uint32_t architecture = 0;
#endif

constexpr std::uint32_t first_x32_call = 0x40000000;

// They fail with EPERM, as they do for anybody without privileges: programs know how to go on.
constexpr std::array refused{SYS_ptrace,
                             SYS_process_vm_readv,
                             SYS_process_vm_writev,
                             SYS_mount,
                             SYS_umount2,
                             SYS_pivot_root,
                             SYS_chroot,
                             SYS_setns,
                             SYS_unshare,
                             SYS_bpf,
                             SYS_perf_event_open,
                             SYS_kexec_load,
                             SYS_init_module,
                             SYS_finit_module,
                             SYS_delete_module,
                             SYS_keyctl,
                             SYS_add_key,
                             SYS_request_key,
                             SYS_userfaultfd,
                             SYS_io_uring_setup,
                             SYS_reboot,
                             SYS_swapon,
                             SYS_swapoff,
                             SYS_settimeofday,
                             SYS_clock_settime,
                             SYS_open_by_handle_at,
                             SYS_quotactl,
                             SYS_acct,
                             SYS_socket};

constexpr std::uint32_t fails_with(int error) { return SECCOMP_RET_ERRNO | static_cast<std::uint32_t>(error); }

constexpr sock_filter load(std::size_t offset) {
  return BPF_STMT(BPF_LD | BPF_W | BPF_ABS, static_cast<std::uint32_t>(offset));
}
constexpr sock_filter give(std::uint32_t value) { return BPF_STMT(BPF_RET | BPF_K, value); }
constexpr sock_filter unless(std::uint32_t code, std::uint32_t value) {  // ... holds, the next one is skipped
  return BPF_JUMP(BPF_JMP | code | BPF_K, value, 0, 1);
}

constexpr auto make_program() {
  constexpr std::size_t head = 6, call_rules = 2 * refused.size(), clone_rules = 6;
  std::array<sock_filter, head + call_rules + clone_rules + 1> program{};
  std::size_t at = 0;
  program[at++] = load(offsetof(seccomp_data, arch));
  program[at++] = BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, architecture, 1, 0);
  program[at++] = give(fails_with(EPERM));  // another architecture's numbers mean other calls
  program[at++] = load(offsetof(seccomp_data, nr));
  program[at++] = unless(BPF_JGE, first_x32_call);
  program[at++] = give(fails_with(EPERM));
  for (const long call : refused) {
    program[at++] = unless(BPF_JEQ, static_cast<std::uint32_t>(call));
    program[at++] = give(fails_with(EPERM));
  }
  // clone3's flags are out of reach; without it the C library falls back to clone.
  program[at++] = unless(BPF_JEQ, SYS_clone3);
  program[at++] = give(fails_with(ENOSYS));
  program[at++] = BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_clone, 0, 3);
  program[at++] = load(offsetof(seccomp_data, args));  // little-endian: the flags' lower half
  program[at++] = unless(BPF_JSET, CLONE_NEWUSER | CLONE_NEWNS | CLONE_NEWNET | CLONE_NEWPID);
  program[at++] = give(fails_with(EPERM));
  program[at++] = give(SECCOMP_RET_ALLOW);
  return program;
}

constexpr auto program = make_program();

}  // namespace

bool install_system_call_filter() noexcept {
  if (architecture == 0) return false;
  const sock_fprog filter{static_cast<unsigned short>(program.size()), const_cast<sock_filter*>(program.data())};
  return ::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter, 0, 0) == 0;
}

}  // namespace sheaf::server
