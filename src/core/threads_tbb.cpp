// Threads of oneTBB, the default. The other way is threads_std.cpp; CMake compiles one of the two (CHIARO_THREADS).
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>

#include "core/threads.h"

namespace chiaro {

void run_pieces(int threads, std::int64_t count, std::int64_t grain,
                const std::function<void(std::int64_t, std::int64_t)>& body) {
    const std::int64_t pieces = (count + grain - 1) / grain;
    // More threads than processors are oneTBB's to refuse, with a line on standard error, unless they are allowed.
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

}  // namespace chiaro
