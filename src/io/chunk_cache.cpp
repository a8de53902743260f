#include "io/chunk_cache.h"

#include <chiaro/error.h>

namespace chiaro {

ChunkCache::Chunk ChunkCache::get(std::uint64_t key, const std::function<Chunk()>& decode) {
    std::unique_lock lock(mutex_);
    for (;;) {
        const auto found = entries_.find(key);
        if (found == entries_.end()) break;
        Entry& entry = found->second;
        if (!entry.fault.empty()) throw Error(ErrorCode::input, entry.fault);
        if (entry.chunk) {
            uses_.splice(uses_.begin(), uses_, entry.use);
            return entry.chunk;
        }
        changed_.wait(lock);
    }
    entries_.try_emplace(key);
    lock.unlock();
    const auto end_with = [&](const auto& set) {
        lock.lock();
        set();
        changed_.notify_all();
    };
    try {
        Chunk chunk = decode();
        end_with([&] { keep(entries_.at(key), key, chunk); });
        return chunk;
    } catch (const Error& error) {
        end_with([&] {
            if (error.code() == ErrorCode::input)
                entries_.at(key).fault = error.what();
            else
                entries_.erase(key);
        });
        throw;
    } catch (...) {
        end_with([&] { entries_.erase(key); });
        throw;
    }
}

void ChunkCache::keep(Entry& entry, std::uint64_t key, Chunk chunk) {
    bytes_ += chunk->size();
    entry.chunk = std::move(chunk);
    entry.use = uses_.insert(uses_.begin(), key);
    let_go();
}

void ChunkCache::keep_at_most(std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    max_bytes_ = bytes;
    let_go();
}

void ChunkCache::let_go() {
    while (bytes_ > max_bytes_ && uses_.size() > 1) {
        const auto oldest = entries_.find(uses_.back());
        bytes_ -= oldest->second.chunk->size();
        entries_.erase(oldest);
        uses_.pop_back();
    }
}

}  // namespace chiaro
