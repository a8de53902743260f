// What is made when it is first asked for.
#pragma once
#include <atomic>
#include <memory>
#include <mutex>

namespace chiaro {

/// By whichever thread asks first; the others wait. Where `make` throws, the next to ask tries again: std::call_once
/// would do the same, but hangs after an exception on some platforms (GCC's bug 66146) and under the thread sanitizer.
template <class T>
class Lazy {
public:
    template <class Make>
    const T& operator()(const Make& make) const {
        if (const T* const made = made_.load(std::memory_order_acquire)) return *made;
        const std::lock_guard lock(making_);
        if (!value_) {
            value_ = std::make_unique<const T>(make());
            made_.store(value_.get(), std::memory_order_release);
        }
        return *value_;
    }

private:
    mutable std::mutex making_;
    mutable std::unique_ptr<const T> value_;
    mutable std::atomic<const T*> made_{nullptr};
};

}  // namespace chiaro
