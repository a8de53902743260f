#include "decode/limits.h"

#include "io/wire.h"

#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstddef>

namespace chiaro::decode {
namespace {

void limit(int resource, std::uint64_t value) {
    const rlimit both{value, value};
    setrlimit(__rlimit_resource_t(resource), &both);
}

/// System calls that no decoder needs and an attacker would like fail with EPERM.
void forbid_system_calls() {
#ifdef __x86_64__
    constexpr auto forbidden = [](unsigned call) {
        return sock_filter BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, call, 0, 1);
    };
    constexpr auto result = [](unsigned action) { return sock_filter BPF_STMT(BPF_RET | BPF_K, action); };
    constexpr unsigned deny = SECCOMP_RET_ERRNO | EPERM;
    sock_filter program[] = {BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, arch)),
                             BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, AUDIT_ARCH_X86_64, 1, 0),
                             result(SECCOMP_RET_KILL_PROCESS),
                             BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
                             BPF_JUMP(BPF_JMP | BPF_JGE | BPF_K, 0x40000000, 0, 1),
                             result(SECCOMP_RET_KILL_PROCESS),  // the x32 twins of all calls
                             forbidden(SYS_socket),
                             result(deny),
                             forbidden(SYS_connect),
                             result(deny),
                             forbidden(SYS_execve),
                             result(deny),
                             forbidden(SYS_execveat),
                             result(deny),
                             forbidden(SYS_fork),
                             result(deny),
                             forbidden(SYS_vfork),
                             result(deny),
                             forbidden(SYS_ptrace),
                             result(deny),
                             forbidden(SYS_unlink),
                             result(deny),
                             forbidden(SYS_unlinkat),
                             result(deny),
                             forbidden(SYS_rename),
                             result(deny),
                             forbidden(SYS_renameat),
                             result(deny),
                             forbidden(SYS_renameat2),
                             result(deny),
                             forbidden(SYS_kill),
                             result(deny),
                             forbidden(SYS_process_vm_writev),
                             result(deny),
                             result(SECCOMP_RET_ALLOW)};
    const sock_fprog filter{sizeof program / sizeof *program, program};
    prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter);
#endif
}

}  // namespace

void limit_this_process(const Limits& limits) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
    syscall(SYS_close_range, wire::messages_descriptor + 1, ~0u, 0);  // whatever the parent forgot to close
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)   // which map terabytes
    constexpr std::uint64_t working_memory = std::uint64_t(1) << 30;
    limit(RLIMIT_AS, limits.max_bytes + working_memory);
#endif
    limit(RLIMIT_CPU, limits.cpu_seconds);
    limit(RLIMIT_FSIZE, limits.max_bytes);
    limit(RLIMIT_NOFILE, 64);
    limit(RLIMIT_CORE, 0);
    signal(SIGXFSZ, SIG_IGN);
    signal(SIGINT, SIG_IGN);  // Ctrl-C reaches the parent too, which ends us
    forbid_system_calls();
}

}  // namespace chiaro::decode
