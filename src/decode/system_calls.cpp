#include "decode/system_calls.h"

#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/landlock.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace chiaro::decode {
namespace {

constexpr std::uint64_t reading = LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR;
constexpr std::uint64_t of_first_version = (std::uint64_t(LANDLOCK_ACCESS_FS_MAKE_SYM) << 1) - 1;

/// What is below `path`, or the file itself, may be used so; nothing where it is not there.
void permit_below(int rules, const std::string& path, std::uint64_t access) {
    const int place = open(path.c_str(), O_PATH | O_CLOEXEC);
    if (place < 0) return;
    struct stat status {};
    if (fstat(place, &status) == 0 && !S_ISDIR(status.st_mode)) access &= LANDLOCK_ACCESS_FS_READ_FILE;
    landlock_path_beneath_attr rule{};
    rule.allowed_access = access;
    rule.parent_fd = place;
    syscall(SYS_landlock_add_rule, rules, LANDLOCK_RULE_PATH_BENEATH, &rule, 0);
    close(place);
}

/// Nothing may be run or written to, nor read where only some may be, but what is named.
void confine_files(const Permissions& permissions) {
    landlock_ruleset_attr all{};
    all.handled_access_fs = permissions.reads_all ? of_first_version & ~reading : of_first_version;
    const int rules = int(syscall(SYS_landlock_create_ruleset, &all, sizeof all.handled_access_fs, 0));
    if (rules < 0) return;
    if (!permissions.reads_all)
        for (const std::string& path : permissions.readable) permit_below(rules, path, reading);
    if (!permissions.writable.empty())
        permit_below(rules, permissions.writable,
                     all.handled_access_fs & (reading | LANDLOCK_ACCESS_FS_WRITE_FILE | LANDLOCK_ACCESS_FS_MAKE_REG |
                                              LANDLOCK_ACCESS_FS_REMOVE_FILE));
    syscall(SYS_landlock_restrict_self, rules, 0);
    close(rules);
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

/// What a program that speaks to servers needs beside that.
constexpr std::array network{SYS_connect,    SYS_bind,     SYS_getsockname, SYS_getpeername, SYS_getsockopt,
                             SYS_setsockopt, SYS_sendto,   SYS_recvfrom,    SYS_sendmsg,     SYS_recvmsg,
                             SYS_sendmmsg,   SYS_shutdown, SYS_socketpair,  SYS_ioctl,       SYS_ppoll,
                             SYS_select,     SYS_pselect6, SYS_pipe2,       SYS_rseq};

void permit(Program& program, long call) {
    program.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, unsigned(call), 0, 1));
    program.push_back(end_with(SECCOMP_RET_ALLOW));
}

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

/// Sockets of the internet, and of the kernel's list of addresses, and threads, which look names up.
void permit_network(Program& program) {
    for (const long call : network) permit(program, call);
    program.insert(
        program.end(),
        {BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_socket, 0, 6), load(offsetof(seccomp_data, args)),
         BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, AF_INET, 3, 0), BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, AF_INET6, 2, 0),
         BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, AF_NETLINK, 1, 0), end_with(denied), end_with(SECCOMP_RET_ALLOW)});
    program.insert(
        program.end(),
        {BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_clone, 0, 4), load(offsetof(seccomp_data, args)),
         BPF_JUMP(BPF_JMP | BPF_JSET | BPF_K, CLONE_THREAD, 1, 0), end_with(denied), end_with(SECCOMP_RET_ALLOW)});
    // Its arguments cannot be seen from here; the C library takes clone then.
    program.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_clone3, 0, 1));
    program.push_back(end_with(SECCOMP_RET_ERRNO | ENOSYS));
}

void filter_system_calls(const Permissions& permissions) {
    constexpr unsigned writing = O_WRONLY | O_RDWR | O_CREAT | O_TRUNC;
    Program program{load(offsetof(seccomp_data, arch)), BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, AUDIT_ARCH_X86_64, 1, 0),
                    end_with(SECCOMP_RET_KILL_PROCESS), load(offsetof(seccomp_data, nr))};
    for (const long call : allowed) permit(program, call);
    if (permissions.network) permit_network(program);
    const bool writes = !permissions.writable.empty();
    permit_without(program, SYS_open, 1, writes ? 0 : writing);
    permit_without(program, SYS_openat, 2, writes ? 0 : writing);
    if (writes)
        for (const long call : {SYS_rename, SYS_renameat, SYS_unlink, SYS_unlinkat, SYS_utimensat})
            permit(program, call);
    permit_without(program, SYS_mmap, 2, PROT_EXEC);
    permit_without(program, SYS_mprotect, 2, PROT_EXEC);
    permit_without(program, SYS_prlimit64, 0, ~0u);  // of this process alone
    permit_signals_to_self(program);
    program.push_back(end_with(denied));
    const sock_fprog filter{static_cast<unsigned short>(program.size()), program.data()};
    prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter);
}
#else
void filter_system_calls(const Permissions&) {}
#endif

}  // namespace

void restrict_system_calls(const Permissions& permissions) {
    confine_files(permissions);
    filter_system_calls(permissions);
}

}  // namespace chiaro::decode
