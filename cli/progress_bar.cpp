#include "progress_bar.h"

#include <chiaro/error.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace chiaro::cli {

ProgressBar::ProgressBar(const std::string& when, bool quiet) {
    if (when != "auto" && when != "always" && when != "never")
        throw Error(ErrorCode::usage, fmt::format("--progress {}: must be auto, always or never", when));
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
    if (now - start_ < 500ms || (visible_ && now - last_ < 50ms)) return;
    last_ = now;
    visible_ = true;
    constexpr int width = 30;
    const double done = std::clamp(fraction, 0.0, 1.0);
    const std::string filled(std::size_t(done * width), '#');
    fmt::print(stderr, "\r\x1b[K{:<12} [{:<{}}] {:3.0f} %", stage, filled, width, 100 * done);
    std::fflush(stderr);
}

void ProgressBar::clear() {
    const std::lock_guard lock(mutex_);
    if (visible_) fmt::print(stderr, "\r\x1b[K");
    visible_ = false;
}

}  // namespace chiaro::cli
