// One thread's work, in the order in which it was asked for.
#pragma once
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

namespace chiaro::server {

/// The thread starts with the first work. Work must not throw.
class SerialQueue {
public:
    SerialQueue() = default;
    ~SerialQueue();  ///< waits for the work that is under way and forgets the rest
    /// False where too much waits already.
    bool post(std::function<void()> work);

private:
    void run();

    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<std::function<void()>> waiting_;
    bool ending_ = false;
    std::thread thread_;
};

}  // namespace chiaro::server
