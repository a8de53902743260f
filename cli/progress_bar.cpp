#include "progress_bar.h"

#include <chiaro/error.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "core/did_you_mean.h"

namespace chiaro::cli {

ProgressBar::ProgressBar(const std::string& when, bool quiet) {
    if (when != "auto" && when != "always" && when != "never")
        throw Error(ErrorCode::usage,
                    fmt::format("--progress {}: must be auto, always or never{}", when,
                                did_you_mean(when, std::vector<std::string>{"auto", "always", "never"})));
    enabled_ = when == "always" || (when == "auto" && !quiet && isatty(STDERR_FILENO));
}

ProgressBar::~ProgressBar() { clear(); }

Progress::Report ProgressBar::report() {
    return [this](std::string_view stage, double fraction) { show(stage, fraction); };
}

void ProgressBar::show(std::string_view stage, double fraction) {
    using namespace std::chrono_literals;
    if (!enabled_) return;
    const std::lock_guard lock(mutex_);
    const auto now = Clock::now();
    if (stage != stage_ || fraction < fraction_) stage_ = stage, stage_start_ = now;
    fraction_ = fraction;
    if (now - start_ < 500ms || (visible_ && now - last_ < 50ms)) return;
    last_ = now;
    visible_ = true;
    constexpr int width = 30;
    const double done = std::clamp(fraction, 0.0, 1.0);
    const std::string filled(std::size_t(done * width), '#');
    const std::string line =
        fmt::format("\r\x1b[K{:<12} [{:<{}}] {:3.0f} %{}", stage, filled, width, 100 * done, time_left(done, now));
    std::fputs(line.c_str(), stderr);  // which fails without a word: nobody watches
    std::fflush(stderr);
}

std::string ProgressBar::time_left(double done, Clock::time_point now) const {
    using namespace std::chrono_literals;
    const auto passed = now - stage_start_;
    if (passed < 1s || done < 0.02 || done >= 1) return "";
    const double seconds = std::chrono::duration<double>(passed).count() * (1 - done) / done;
    return seconds < 90 ? fmt::format(", {:.0f} s left", std::ceil(seconds))
                        : fmt::format(", {:.0f} min left", seconds / 60);
}

void ProgressBar::clear() {
    const std::lock_guard lock(mutex_);
    if (visible_) std::fputs("\r\x1b[K", stderr);
    visible_ = false;
}

}  // namespace chiaro::cli
