#include "decode/limits.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <sstream>

namespace chiaro::decode {
namespace {

void limit(int resource, std::uint64_t value) {
    const rlimit both{value, value};
    setrlimit(__rlimit_resource_t(resource), &both);
}

/// Where memory runs out for everybody, this process is the one to end, not the program that waits for it.
void be_the_first_to_go() {
    const int file = open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC);
    if (file < 0) return;
    [[maybe_unused]] const auto written = write(file, "1000", 4);
    close(file);
}

/// Bytes of writable memory that no other process sees.
std::uint64_t own_memory() {
    static const int file = open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
    char text[256] = {};
    if (pread(file, text, sizeof text - 1, 0) <= 0) return 0;
    std::istringstream columns(text);
    std::uint64_t pages = 0;
    for (int column = 0; column < 6; ++column) columns >> pages;
    return columns ? pages * std::uint64_t(sysconf(_SC_PAGESIZE)) : 0;
}

}  // namespace

void limit_own_memory([[maybe_unused]] std::uint64_t bytes) {
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
    rlimit limits{};
    const std::uint64_t now = own_memory();
    if (now == 0 || getrlimit(RLIMIT_DATA, &limits) != 0) return;
    limits.rlim_cur = std::min<rlim_t>(limits.rlim_max, now + bytes);
    setrlimit(RLIMIT_DATA, &limits);
#endif
}

void limit_cpu_from_now(unsigned seconds) {
    rlimit limits{};
    rusage used{};
    if (getrlimit(RLIMIT_CPU, &limits) != 0 || getrusage(RUSAGE_SELF, &used) != 0) return;
    limits.rlim_cur =
        std::min<rlim_t>(limits.rlim_max, rlim_t(used.ru_utime.tv_sec + used.ru_stime.tv_sec) + 1 + seconds);
    setrlimit(RLIMIT_CPU, &limits);
}

void limit_this_process(const Limits& limits) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
    syscall(SYS_close_range, limits.last_descriptor + 1, ~0u, 0);  // whatever the parent forgot to close
    be_the_first_to_go();
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // which map terabytes
    constexpr std::uint64_t working_memory = std::uint64_t(1) << 30;
    limit(RLIMIT_AS, limits.max_bytes + working_memory);
#endif
    if (limits.is_by_request)
        limit_cpu_from_now(limits.cpu_seconds);
    else
        limit(RLIMIT_CPU, limits.cpu_seconds);
    limit(RLIMIT_FSIZE, limits.max_bytes);  // the memory file, which alone can be written to
    limit(RLIMIT_NOFILE, 64);
    limit(RLIMIT_CORE, 0);
    signal(SIGXFSZ, SIG_IGN);
    signal(SIGINT, SIG_IGN);  // Ctrl-C reaches the parent too, which ends us
    signal(SIGTERM, SIG_IGN);
    own_memory();  // which opens what tells it
    restrict_system_calls(limits.permissions);
}

}  // namespace chiaro::decode
