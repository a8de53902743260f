// Threads of the standard library, for the thread sanitizer, which does not know how oneTBB synchronizes. Each call
// starts its own threads: slower than oneTBB, but no pool's locks hide a race between two calls.
#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#include "core/threads.h"

namespace chiaro {

void run_pieces(int threads, std::int64_t count, std::int64_t grain,
                const std::function<void(std::int64_t, std::int64_t)>& body) {
    const std::int64_t pieces = (count + grain - 1) / grain;
    // Relaxed: it orders nothing else, so that the sanitizer takes pieces for as independent as they must be.
    std::atomic<std::int64_t> next{0};
    std::mutex failing;
    std::exception_ptr failure;  // the first
    const auto work = [&] {
        try {
            for (std::int64_t piece; (piece = next.fetch_add(1, std::memory_order_relaxed)) < pieces;)
                body(piece * grain, std::min(count, (piece + 1) * grain));
        } catch (...) {
            next.store(pieces, std::memory_order_relaxed);  // the pieces that are left are not begun
            const std::lock_guard lock(failing);
            if (!failure) failure = std::current_exception();
        }
    };
    {
        std::vector<std::jthread> others;  // the caller works too
        try {
            for (std::int64_t i = 1; i < std::min<std::int64_t>(threads, pieces); ++i) others.emplace_back(work);
        } catch (const std::system_error&) {  // the system gives no more threads: those that are there do the work
        }
        work();
    }
    if (failure) std::rethrow_exception(failure);
}

}  // namespace chiaro
