// The chunks that were decoded last.
#pragma once
#include <chiaro/volume.h>

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>

namespace chiaro {

/// Each is decoded once, however many threads ask for it. One that cannot be is not tried again.
class ChunkCache {
public:
    using Chunk = std::shared_ptr<const VoxelBuffer>;
    explicit ChunkCache(std::size_t max_bytes) : max_bytes_(max_bytes) {}
    void keep_at_most(std::size_t bytes);

    /// The chunk of this key, made by `decode` where it is not there. Throws what that throws.
    Chunk get(std::uint64_t key, const std::function<Chunk()>& decode);

private:
    struct Entry {
        Chunk chunk;                             ///< null: being decoded
        std::string fault;                       ///< why it cannot be
        std::list<std::uint64_t>::iterator use;  ///< of those that are there
    };
    void keep(Entry& entry, std::uint64_t key, Chunk chunk);
    void let_go();

    std::size_t max_bytes_, bytes_ = 0;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::unordered_map<std::uint64_t, Entry> entries_;
    std::list<std::uint64_t> uses_;  ///< the last one first
};

}  // namespace chiaro
