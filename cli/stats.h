// What a run did, as JSON: --stats.
#pragma once
#include <chiaro/device.h>
#include <chiaro/session.h>

#include <chrono>
#include <ctime>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "json.h"

namespace chiaro::cli {

/// On the wall, and of all threads together.
struct FrameTime {
    double seconds, cpu_seconds;
    int moment = 0;  ///< that was shown, of several
};

struct Stats {
    Json volume;
    std::vector<Stage> stages;           ///< in order; the stages of the first picture
    std::vector<FrameTime> frames;       ///< one for each picture
    std::uint64_t samples = 0;           ///< at which the volume was read, in all these pictures
    PathStatistics paths;                ///< of the last picture, if it was path-traced
    std::optional<PagingReport> paging;  ///< of the last picture, if the volume was read by bricks

    /// Runs the work as a stage and returns what it returns.
    template <class Work>
    auto stage(const char* name, Work&& work) {
        const auto start = std::chrono::steady_clock::now();
        const auto keep = [&] {
            stages.push_back({name, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()});
        };
        if constexpr (std::is_void_v<decltype(work())>) {
            work(), keep();
        } else {
            auto result = work();
            keep();
            return result;
        }
    }

    /// Runs the work and returns its seconds.
    template <class Work>
    static double time(Work&& work) {
        const auto start = std::chrono::steady_clock::now();
        work();
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    }

    template <class Work>
    static FrameTime frame_time(Work&& work) {
        const std::clock_t start = std::clock();
        const double seconds = time(work);
        return {seconds, double(std::clock() - start) / CLOCKS_PER_SEC, 0};
    }
};

/// One line with the time of every stage.
void tell_stages(const Stats& stats, const Device& device);
/// The same of a command that needs no device.
void tell_stages(const Stats& stats);

/// One line that says how sure a path-traced picture is.
void tell_noise(const PathStatistics& paths);

/// Throws Error{output}.
void write_stats(const std::filesystem::path& path, const Stats& stats, const Device& device, const Scene& scene);

}  // namespace chiaro::cli
