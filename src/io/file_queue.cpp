#include "io/file_queue.h"

#include <span>

#include "core/atomic_file.h"

namespace chiaro {
namespace {

constexpr int max_at_once = 2;            // one is brought to the disk while another is sent there
constexpr std::uint64_t max_pending = 3;  // handed over and not done

}  // namespace

FileQueue::FileQueue(std::size_t max_bytes) : max_bytes_(max_bytes) {
    for (int i = 0; i < max_at_once; ++i) threads_.emplace_back([this] { run(); });
}

FileQueue::~FileQueue() {
    {
        const std::lock_guard lock(mutex_);
        is_over_ = true;
    }
    changed_.notify_all();
    for (auto& thread : threads_) thread.join();
}

VoxelBuffer FileQueue::room() {
    const std::lock_guard lock(mutex_);
    if (free_.empty()) return VoxelBuffer(max_bytes_);
    VoxelBuffer bytes = std::move(free_.back());
    free_.pop_back();
    return bytes;
}

void FileQueue::write(std::filesystem::path path, VoxelBuffer bytes, std::size_t size) {
    std::unique_lock lock(mutex_);
    wait_until_left(lock, max_pending - 1);
    waiting_.push_back({std::move(path), std::move(bytes), size, handed_over_++});
    changed_.notify_all();
}

void FileQueue::finish() {
    std::unique_lock lock(mutex_);
    wait_until_left(lock, 0);
}

void FileQueue::wait_until_left(std::unique_lock<std::mutex>& lock, std::uint64_t most) {
    changed_.wait(lock, [&] { return handed_over_ - done_ <= most || fault_; });
    if (fault_) std::rethrow_exception(fault_);
}

void FileQueue::run() {
    for (;;) {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return !waiting_.empty() || is_over_; });
        if (waiting_.empty()) return;
        File file = std::move(waiting_.front());
        waiting_.pop_front();
        lock.unlock();
        std::exception_ptr fault;
        try {
            write_one(file);
        } catch (...) {
            fault = std::current_exception();
        }
        lock.lock();
        changed_.wait(lock, [&] { return done_ == file.number; });
        if (!fault_) fault_ = fault;
        ++done_;
        free_.push_back(std::move(file.bytes));
        changed_.notify_all();
    }
}

void FileQueue::write_one(const File& file) {
    std::filesystem::create_directories(file.path.parent_path());
    AtomicFile on_disk(file.path);
    on_disk.write_past_cache(std::span(file.bytes.data(), file.size));
    on_disk.flush();
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return done_ == file.number; });
    if (!fault_) on_disk.commit();
}

}  // namespace chiaro
