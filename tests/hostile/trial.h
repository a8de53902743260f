// A file judged in a process of its own: what it costs, and what is wrong with the outcome.
#pragma once
#include "hostile/judgement.h"
#include "hostile/mutations.h"

#include <sys/resource.h>
#include <sys/types.h>

#include <array>
#include <string_view>

namespace hostile {

/// A judgement and its cost.
struct Outcome {
    Judgement judgement;
    int signal = 0;                ///< that ended the process; 0: none
    double cpu_seconds = 0;        ///< of the process and its decoders together
    std::uint64_t peak_bytes = 0;  ///< of memory: the process or a decoder, whichever had more
};

/// What a file may cost. The address sanitizer's own memory is as large as a program's.
#ifdef __SANITIZE_ADDRESS__
inline constexpr std::uint64_t bytes_of_any_file = 128 << 20;
#else
inline constexpr std::uint64_t bytes_of_any_file = 64 << 20;
#endif
struct Limits {
    double cpu_seconds = 5;
    std::uint64_t bytes_per_byte = 50, bytes = bytes_of_any_file;
    unsigned patience_seconds = 240;  ///< wall time after which a process hangs
};

/// One judgement at a time. The place that it is written to is shared with the process that makes it.
class Trial {
public:
    Trial();
    Trial(const Trial&) = delete;
    Trial& operator=(const Trial&) = delete;
    ~Trial();
    /// Starts a process for `judge`; this one must have no threads.
    pid_t start(const std::function<Judgement()>& judge, const Limits& limits = {});
    /// After wait4 has told the end of it.
    Outcome outcome(int status, const rusage& usage) const;

private:
    struct Report;
    Report* report_;
};

/// Starts one and waits for its end.
Outcome outcome_of(const std::function<Judgement()>& judge, const Limits& limits = {});

enum class Finding { none, crash, hang, sentence, lost, untold, time, memory };
constexpr std::array<std::string_view, 8> finding_names{
    "nothing", "crash", "hang", "refused in no sentence", "cut, no note", "contradiction, no note", "time", "memory"};

/// The worst that is wrong with what became of `mutant`, where `whole` became of its seed: a cut file may only be
/// shown with other contents, and a contradiction only be shown, with a note that the whole file has not.
Finding finding_of(const Seed& seed, const Mutant& mutant, const Outcome& outcome, const Judgement& whole,
                   const Limits& limits = {});

}  // namespace hostile
