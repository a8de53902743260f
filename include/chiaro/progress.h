// Report and cancel, in one small object that every slow call takes.
#pragma once
#include <chiaro/export.h>

#include <atomic>
#include <functional>
#include <string>
#include <string_view>

namespace chiaro {

/// Passed by reference into every slow call. Reports may come from any thread, one at a time; `cancel` from any thread
/// or a signal handler.
class Progress {
public:
    /// Receives the stage's name and the share done in [0, 1].
    using Report = std::function<void(std::string_view stage, double fraction)>;

    Progress() = default;
    explicit Progress(Report report) : report_(std::move(report)) {}
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    void cancel() noexcept { cancelled_.store(true, std::memory_order_relaxed); }
    bool cancelled() const noexcept { return cancelled_.load(std::memory_order_relaxed); }
    void report(std::string_view stage, double fraction) const {
        if (report_) report_(stage, fraction);
    }

    /// Throws Error{interrupted} once cancelled: for stages that have nothing to hand back half-done.
    CHIARO_EXPORT void check() const;

private:
    Report report_;
    std::atomic<bool> cancelled_{false};
};

/// How long one step of the work took.
struct Stage {
    std::string name;
    double seconds = 0;
};

}  // namespace chiaro
