// Files that are written while the caller makes the next ones.
#pragma once
#include <chiaro/volume.h>

#include <condition_variable>
#include <deque>
#include <exception>
#include <filesystem>
#include <mutex>
#include <thread>
#include <vector>

namespace chiaro {

/// Writes a few files at a time, each whole or not at all, past the system's cache. A file takes its name once all have
/// that were handed over before it: what is there of a sequence is its beginning, whenever it is broken off.
class FileQueue {
public:
    /// No file is larger than `max_bytes`; four of these are kept in memory at most.
    explicit FileQueue(std::size_t max_bytes);
    FileQueue(const FileQueue&) = delete;
    FileQueue& operator=(const FileQueue&) = delete;
    ~FileQueue();  ///< once all are written that were handed over, or could not be

    /// Memory for the next file, of max_bytes.
    VoxelBuffer room();
    /// The first `size` bytes become a file, in a folder that is made where it is not there. Waits while there is no
    /// memory for another. Throws Error{output} where an earlier one could not be written.
    void write(std::filesystem::path path, VoxelBuffer bytes, std::size_t size);
    /// Waits for all. Throws as `write`.
    void finish();

private:
    struct File {
        std::filesystem::path path;
        VoxelBuffer bytes;
        std::size_t size = 0;
        std::uint64_t number = 0;
    };
    void run();
    void write_one(const File& file);
    void wait_until_left(std::unique_lock<std::mutex>& lock, std::uint64_t most);

    const std::size_t max_bytes_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<File> waiting_;
    std::vector<VoxelBuffer> free_;
    std::uint64_t handed_over_ = 0, done_ = 0;
    std::exception_ptr fault_;
    bool is_over_ = false;
    std::vector<std::thread> threads_;
};

}  // namespace chiaro
