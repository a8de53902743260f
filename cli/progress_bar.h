// A line on the terminal that shows how far long work has come, and how long its stage will take.
#pragma once
#include <chiaro/progress.h>

#include <chrono>
#include <mutex>
#include <string>
#include <string_view>

namespace chiaro::cli {

/// Shows itself once the work has taken half a second, and wipes itself away at the end.
class ProgressBar {
public:
    /// `when`: auto (on a terminal, unless quiet), always or never. Throws Error{usage} for anything else.
    ProgressBar(const std::string& when, bool quiet);
    ~ProgressBar();
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;

    Progress::Report report();
    /// Wipes the line, so that another can be written.
    void clear();

private:
    using Clock = std::chrono::steady_clock;

    void show(std::string_view stage, double fraction);
    /// ", 12 s left" of the stage, at the pace so far; nothing while that says little.
    std::string time_left(double done, Clock::time_point now) const;

    bool enabled_ = false, visible_ = false;
    Clock::time_point start_ = Clock::now(), last_ = start_, stage_start_ = start_;
    std::string stage_;
    double fraction_ = 0;
    std::mutex mutex_;
};

}  // namespace chiaro::cli
