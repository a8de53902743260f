#include "core/threads.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#include <sched.h>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <thread>

namespace chiaro {
namespace {

using Body = std::function<void(std::int64_t, std::int64_t)>;

void run(int threads, std::int64_t count, std::int64_t grain, const Body& body) {
    const std::int64_t pieces = (count + grain - 1) / grain;
    // More threads than CPUs are oneTBB's to refuse, with a line on standard error, unless they are allowed.
    const oneapi::tbb::global_control allowed(oneapi::tbb::global_control::max_allowed_parallelism,
                                              std::size_t(std::max(threads, usable_threads())));
    oneapi::tbb::task_arena arena(threads);
    arena.execute([&] {
        oneapi::tbb::parallel_for(
            oneapi::tbb::blocked_range<std::int64_t>(0, pieces, 1),
            [&](const oneapi::tbb::blocked_range<std::int64_t>& range) {
                for (auto piece = range.begin(); piece != range.end(); ++piece)
                    body(piece * grain, std::min(count, (piece + 1) * grain));
            },
            oneapi::tbb::simple_partitioner());
    });
}

}  // namespace

int usable_threads() {
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof set, &set) == 0) return std::max(1, CPU_COUNT(&set));
    return std::max(1u, std::thread::hardware_concurrency());
}

bool parallel_for(int threads, std::int64_t count, std::int64_t grain, std::string_view stage, Progress& progress,
                  const Body& body) {
    std::atomic<std::int64_t> done{0};
    std::mutex reporting;
    run(threads, count, grain, [&](std::int64_t first, std::int64_t last) {
        if (progress.cancelled()) return;
        body(first, last);
        const auto sum = done.fetch_add(last - first) + last - first;
        // Whoever finds another thread reporting moves on: progress is a hint, not a queue.
        if (std::unique_lock lock(reporting, std::try_to_lock); lock)
            progress.report(stage, double(sum) / double(count));
    });
    return !progress.cancelled();
}

void parallel_for(int threads, std::int64_t count, std::int64_t grain, const Body& body) {
    run(threads, count, grain, body);
}
void parallel_for(std::int64_t count, std::int64_t grain, const Body& body) {
    run(usable_threads(), count, grain, body);
}

}  // namespace chiaro
