#include "decode/system_calls.h"

#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/landlock.h>
#include <linux/seccomp.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace chiaro::decode {
namespace {

/// A set of rules without one that permits: nothing below / may be written to, made, removed or run.
void forbid_writing_files() {
    constexpr std::uint64_t of_first_version = (std::uint64_t(LANDLOCK_ACCESS_FS_MAKE_SYM) << 1) - 1;
    landlock_ruleset_attr rules{};
    rules.handled_access_fs = of_first_version & ~(LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR);
    const long set = syscall(SYS_landlock_create_ruleset, &rules, sizeof rules.handled_access_fs, 0);
    if (set < 0) return;
    syscall(SYS_landlock_restrict_self, set, 0);
    close(int(set));
}

// The sanitizers' own code pipes and clones.
#if defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
using Program = std::vector<sock_filter>;

constexpr sock_filter load(std::size_t offset) { return BPF_STMT(BPF_LD | BPF_W | BPF_ABS, std::uint32_t(offset)); }
constexpr sock_filter end_with(unsigned action) { return BPF_STMT(BPF_RET | BPF_K, action); }
constexpr unsigned denied = SECCOMP_RET_ERRNO | EPERM;

/// What reading files, computing, giving up and the C library need.
constexpr std::array allowed{SYS_read,
                             SYS_pread64,
                             SYS_readv,
                             SYS_preadv,
                             SYS_lseek,
                             SYS_close,
                             SYS_stat,
                             SYS_fstat,
                             SYS_lstat,
                             SYS_newfstatat,
                             SYS_statx,
                             SYS_statfs,
                             SYS_fstatfs,
                             SYS_access,
                             SYS_faccessat,
                             SYS_faccessat2,
                             SYS_readlink,
                             SYS_readlinkat,
                             SYS_getdents64,
                             SYS_getcwd,
                             SYS_fcntl,
                             SYS_flock,
                             SYS_fadvise64,
                             SYS_dup,
                             SYS_poll,
                             SYS_write,
                             SYS_writev,
                             SYS_ftruncate,
                             SYS_munmap,
                             SYS_mremap,
                             SYS_brk,
                             SYS_madvise,
                             SYS_mincore,
                             SYS_futex,
                             SYS_sched_yield,
                             SYS_nanosleep,
                             SYS_clock_nanosleep,
                             SYS_clock_gettime,
                             SYS_clock_getres,
                             SYS_gettimeofday,
                             SYS_time,
                             SYS_times,
                             SYS_getrusage,
                             SYS_getrandom,
                             SYS_uname,
                             SYS_sysinfo,
                             SYS_getpid,
                             SYS_gettid,
                             SYS_getppid,
                             SYS_getuid,
                             SYS_geteuid,
                             SYS_getgid,
                             SYS_getegid,
                             SYS_rt_sigaction,
                             SYS_rt_sigprocmask,
                             SYS_rt_sigreturn,
                             SYS_sigaltstack,
                             SYS_restart_syscall,
                             SYS_set_robust_list,
                             SYS_sched_getaffinity,
                             SYS_exit,
                             SYS_exit_group};

/// Behind the number of a call, in the accumulator: permits it where argument `index` has none of the bits `forbidden`.
void permit_without(Program& program, unsigned call, unsigned index, unsigned forbidden) {
    program.insert(
        program.end(),
        {BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, call, 0, 4), load(offsetof(seccomp_data, args) + 8 * index),
         BPF_JUMP(BPF_JMP | BPF_JSET | BPF_K, forbidden, 0, 1), end_with(denied), end_with(SECCOMP_RET_ALLOW)});
}

/// abort() signals its own thread; nobody else may be signalled.
void permit_signals_to_self(Program& program) {
    program.insert(
        program.end(),
        {BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_tgkill, 0, 4), load(offsetof(seccomp_data, args)),
         BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, unsigned(getpid()), 1, 0), end_with(denied), end_with(SECCOMP_RET_ALLOW)});
}

void filter_system_calls() {
    constexpr unsigned writing = O_WRONLY | O_RDWR | O_CREAT | O_TRUNC;
    Program program{load(offsetof(seccomp_data, arch)), BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, AUDIT_ARCH_X86_64, 1, 0),
                    end_with(SECCOMP_RET_KILL_PROCESS), load(offsetof(seccomp_data, nr))};
    for (const long call : allowed) {
        program.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, unsigned(call), 0, 1));
        program.push_back(end_with(SECCOMP_RET_ALLOW));
    }
    permit_without(program, SYS_open, 1, writing);
    permit_without(program, SYS_openat, 2, writing);
    permit_without(program, SYS_mmap, 2, PROT_EXEC);
    permit_without(program, SYS_mprotect, 2, PROT_EXEC);
    permit_without(program, SYS_prlimit64, 0, ~0u);  // of this process alone
    permit_signals_to_self(program);
    program.push_back(end_with(denied));
    const sock_fprog filter{static_cast<unsigned short>(program.size()), program.data()};
    prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter);
}
#else
void filter_system_calls() {}
#endif

}  // namespace

void restrict_system_calls() {
    forbid_writing_files();
    filter_system_calls();
}

}  // namespace chiaro::decode
