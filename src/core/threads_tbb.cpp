// Threads of oneTBB, the default. The other way is threads_std.cpp; CMake compiles one of the two (CHIARO_THREADS).
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "core/threads.h"

namespace chiaro {
namespace {

using oneapi::tbb::task_arena;

/// Arenas that wait for the next pass, by their number of threads. An arena that ends leaves some 7 KB behind (oneTBB
/// 2021.8), so none does; there are as many as there were passes at a time.
class Arenas {
public:
    std::unique_ptr<task_arena> take(int threads) {
        {
            const std::lock_guard lock(mutex_);
            if (auto& waiting = waiting_[threads]; !waiting.empty()) {
                auto arena = std::move(waiting.back());
                waiting.pop_back();
                return arena;
            }
        }
        return std::make_unique<task_arena>(threads);
    }
    void give_back(int threads, std::unique_ptr<task_arena> arena) {
        const std::lock_guard lock(mutex_);
        waiting_[threads].push_back(std::move(arena));
    }

private:
    std::mutex mutex_;
    std::map<int, std::vector<std::unique_ptr<task_arena>>> waiting_;
};

/// As long as the process: threads of oneTBB may outlive what is destroyed at its end.
Arenas& arenas() {
    static Arenas& all = *new Arenas;
    return all;
}

/// One for the time of a pass, whatever that throws.
struct Lease {
    explicit Lease(int count) : threads(count), arena(arenas().take(count)) {}
    ~Lease() { arenas().give_back(threads, std::move(arena)); }
    Lease(const Lease&) = delete;
    Lease& operator=(const Lease&) = delete;

    const int threads;
    std::unique_ptr<task_arena> arena;
};

}  // namespace

void run_pieces(int threads, std::int64_t count, std::int64_t grain,
                const std::function<void(std::int64_t, std::int64_t)>& body) {
    const std::int64_t pieces = (count + grain - 1) / grain;
    // More threads than processors are oneTBB's to refuse, with a line on standard error, unless they are allowed.
    const oneapi::tbb::global_control allowed(oneapi::tbb::global_control::max_allowed_parallelism,
                                              std::size_t(std::max(threads, usable_threads())));
    const Lease lease(threads);
    lease.arena->execute([&] {
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
