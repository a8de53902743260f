// The only door to the thread library: oneTBB, or std::thread where that was built (CHIARO_THREADS).
#pragma once
#include <chiaro/device.h>
#include <chiaro/progress.h>

#include <cstdint>
#include <functional>
#include <string_view>

namespace chiaro {

/// How many threads the process may use: its affinity mask, not the machine's size.
int usable_threads();

/// Calls body(first, last) over disjoint pieces of [0, count), each at most `grain` long, on up to `threads` threads,
/// and reports the share done under `stage`. Stops early, returning false, once `progress` is cancelled. Which thread
/// takes which piece is not fixed: pieces must be independent. An exception thrown by `body` is rethrown here.
bool parallel_for(int threads, std::int64_t count, std::int64_t grain, std::string_view stage, Progress& progress,
                  const std::function<void(std::int64_t first, std::int64_t last)>& body);

/// The same, silent: for passes of milliseconds. Throws Error{interrupted} where a CancelScope of this thread says so.
void parallel_for(int threads, std::int64_t count, std::int64_t grain,
                  const std::function<void(std::int64_t, std::int64_t)>& body);
/// While one lives, silent passes that its thread begins end once `progress` is cancelled: a call's many short passes
/// need not hand it on.
class CancelScope {
public:
    explicit CancelScope(const Progress& progress);
    ~CancelScope();
    CancelScope(const CancelScope&) = delete;
    CancelScope& operator=(const CancelScope&) = delete;

private:
    const Progress* outer_;
};

/// On all usable threads.
void parallel_for(std::int64_t count, std::int64_t grain, const std::function<void(std::int64_t, std::int64_t)>& body);

/// Of the thread library: the pieces of a pass, none of which is left out.
void run_pieces(int threads, std::int64_t count, std::int64_t grain,
                const std::function<void(std::int64_t, std::int64_t)>& body);

}  // namespace chiaro
