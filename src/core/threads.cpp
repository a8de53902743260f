#include "core/threads.h"

#include "core/cancel.h"
#include "core/thread_limit.h"

#include <sched.h>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <thread>
#include <utility>

namespace chiaro {
namespace {

std::atomic<int> thread_limit{0};
thread_local const Progress* current_call = nullptr;
thread_local const Progress* piece_of = nullptr;  // the call whose piece this thread works on

/// Calls body for a piece.
void work_for(const Progress& call, const std::function<void(std::int64_t, std::int64_t)>& body, std::int64_t first,
              std::int64_t last) {
    struct Restored {
        const Progress* before;
        ~Restored() { piece_of = before; }
    } const restored{std::exchange(piece_of, &call)};
    body(first, last);
}

}  // namespace

void limit_threads(int count) { thread_limit.store(count, std::memory_order_relaxed); }

int usable_threads() {
    if (const int limit = thread_limit.load(std::memory_order_relaxed)) return limit;
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof set, &set) == 0) return std::max(1, CPU_COUNT(&set));
    return std::max(1u, std::thread::hardware_concurrency());
}

bool parallel_for(int threads, std::int64_t count, std::int64_t grain, std::string_view stage, Progress& progress,
                  const std::function<void(std::int64_t, std::int64_t)>& body) {
    std::atomic<std::int64_t> done{0};
    std::mutex reporting;
    run_pieces(threads, count, grain, [&](std::int64_t first, std::int64_t last) {
        if (progress.cancelled()) return;
        work_for(progress, body, first, last);
        const auto sum = done.fetch_add(last - first, std::memory_order_relaxed) + last - first;
        // Whoever finds another thread reporting moves on: progress is a hint, not a queue.
        if (std::unique_lock lock(reporting, std::try_to_lock); lock)
            progress.report(stage, double(sum) / double(count));
    });
    return !progress.cancelled();
}

CancelScope::CancelScope(const Progress& progress) : outer_(std::exchange(current_call, &progress)) {}
CancelScope::~CancelScope() { current_call = outer_; }

void check_cancelled() {
    if (current_call) current_call->check();
    if (piece_of) piece_of->check();
}

void parallel_for(int threads, std::int64_t count, std::int64_t grain,
                  const std::function<void(std::int64_t, std::int64_t)>& body) {
    const Progress* const call = current_call;
    if (!call) return run_pieces(threads, count, grain, body);
    run_pieces(threads, count, grain, [&](std::int64_t first, std::int64_t last) {
        if (!call->cancelled()) work_for(*call, body, first, last);
    });
    call->check();
}

void parallel_for(std::int64_t count, std::int64_t grain, const std::function<void(std::int64_t, std::int64_t)>& body) {
    parallel_for(usable_threads(), count, grain, body);
}

}  // namespace chiaro
