#include "hostile/trial.h"

#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstring>
#include <new>

namespace hostile {

struct Trial::Report {
    bool is_read, is_doubted;
    std::uint64_t contents, notes;
    char sentence[2048], fault[256];
};

namespace {

template <std::size_t n>
void put(char (&to)[n], const std::string& text) {
    to[text.copy(to, n - 1)] = '\0';
}

double seconds(const timeval& time) { return double(time.tv_sec) + 1e-6 * double(time.tv_usec); }

/// Beyond the limit of time, so that what ends by it is seen to have passed it. Decoders set limits of their own.
void end_what_never_ends(const Limits& limits) {
    rlimit cpu{};
    getrlimit(RLIMIT_CPU, &cpu);
    cpu.rlim_cur = rlim_t(std::ceil(limits.cpu_seconds)) + 1;
    setrlimit(RLIMIT_CPU, &cpu);
    signal(SIGXCPU, SIG_DFL);
    signal(SIGALRM, SIG_DFL);
    alarm(limits.patience_seconds);
}

}  // namespace

Trial::Trial() {
    void* shared = mmap(nullptr, sizeof(Report), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (shared == MAP_FAILED) throw std::bad_alloc();
    report_ = new (shared) Report{};
}

Trial::~Trial() { munmap(report_, sizeof(Report)); }

pid_t Trial::start(const std::function<Judgement()>& judge, const Limits& limits) {
    *report_ = {};
    const pid_t process = fork();
    if (process != 0) return process;
    end_what_never_ends(limits);
    const Judgement found = judge();
    report_->is_read = found.is_read, report_->is_doubted = found.is_doubted;
    report_->contents = found.contents, report_->notes = found.notes;
    put(report_->sentence, found.sentence), put(report_->fault, found.fault);
    _exit(0);
}

Outcome Trial::outcome(int status, const rusage& usage) const {
    Outcome outcome;
    outcome.judgement = {report_->is_read,    report_->contents, report_->sentence,
                         report_->is_doubted, report_->notes,    report_->fault};
    outcome.signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
    outcome.cpu_seconds = seconds(usage.ru_utime) + seconds(usage.ru_stime);
    outcome.peak_bytes = std::uint64_t(usage.ru_maxrss) * 1024;
    return outcome;
}

Outcome outcome_of(const std::function<Judgement()>& judge, const Limits& limits) {
    Trial trial;
    const pid_t process = trial.start(judge, limits);
    int status = 0;
    rusage usage{};
    while (wait4(process, &status, 0, &usage) < 0 && errno == EINTR) {
    }
    return trial.outcome(status, usage);
}

Finding finding_of(const Seed& seed, const Mutant& mutant, const Outcome& outcome, const Judgement& whole,
                   const Limits& limits) {
    const Judgement& found = outcome.judgement;
    std::uint64_t size = mutant.bytes.size();
    for (const auto& [name, beside] : seed.beside) size += beside.size();
    const bool is_untold = found.is_read && found.notes == whole.notes;
    if (outcome.signal == SIGALRM) return Finding::hang;
    if (outcome.signal == SIGXCPU || outcome.cpu_seconds > limits.cpu_seconds) return Finding::time;
    if (outcome.signal != 0) return Finding::crash;
    const bool is_lost = !seed.is_open_ended && (seed.needs_end || found.contents != whole.contents);
    if (is_untold && mutant.is_cut && is_lost) return Finding::lost;
    if (is_untold && mutant.is_contradiction) return Finding::untold;
    if (!found.fault.empty()) return Finding::sentence;
    if (outcome.peak_bytes > limits.bytes_per_byte * size + limits.bytes) return Finding::memory;
    return Finding::none;
}

}  // namespace hostile
