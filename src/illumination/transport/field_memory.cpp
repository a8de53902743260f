#include "illumination/transport/field_memory.h"

#include <chiaro/error.h>
#include <chiaro/volume.h>

#include <algorithm>
#include <cstdint>
#include <list>
#include <mutex>
#include <vector>

namespace chiaro {
namespace {

constexpr std::size_t line = 64, little = 1 << 16, slab_bytes = 16 << 20, max_kept = 64 << 20;

/// Fields that begin at the same place of a page would take each other's place in the cache.
std::size_t block_for(std::size_t bytes) { return (bytes + line - 1) / line * line + 5 * line; }

VoxelBuffer room_for(std::size_t bytes) {
    try {
        return VoxelBuffer(bytes);
    } catch (const Error& error) {
        throw Error(error.code(), "not enough memory for " + std::to_string(bytes >> 20) +
                                      " MiB more of the grid of light; a smaller --transport-grid needs less");
    }
}

/// Blocks of one size.
struct Slab {
    VoxelBuffer memory;
    std::size_t block, used = 0;
    std::vector<std::byte*> free;

    explicit Slab(std::size_t size)
        : memory(room_for(std::max<std::size_t>(1, slab_bytes / size) * size + line)), block(size) {
        const auto start = reinterpret_cast<std::uintptr_t>(memory.data());
        std::byte* first = memory.data() + (line - start % line) % line;
        for (std::size_t at = (memory.size() - line) / size; at-- > 0;) free.push_back(first + at * size);
    }
    bool holds(const std::byte* p) const { return p >= memory.data() && p < memory.data() + memory.size(); }
};

class Slabs {
public:
    void* take(std::size_t size) {
        const std::lock_guard lock(mutex_);
        auto slab = std::find_if(slabs_.begin(), slabs_.end(),
                                 [&](const Slab& s) { return s.block == size && !s.free.empty(); });
        if (slab == slabs_.end()) slab = slabs_.emplace(slabs_.end(), size);
        std::byte* taken = slab->free.back();
        slab->free.pop_back();
        ++slab->used;
        return taken;
    }
    void give(std::byte* p) noexcept {
        const std::lock_guard lock(mutex_);
        const auto slab = std::find_if(slabs_.begin(), slabs_.end(), [&](const Slab& s) { return s.holds(p); });
        slab->free.push_back(p);  // had its place there before
        if (--slab->used > 0) return;
        slabs_.splice(slabs_.end(), slabs_, slab);  // the last to be freed is the last to go
        std::size_t kept = 0;
        for (auto s = slabs_.end(); s != slabs_.begin();) {
            --s;
            if (s->used > 0) continue;
            kept += s->memory.size();
            if (kept > max_kept) s = slabs_.erase(s);
        }
    }

private:
    std::mutex mutex_;
    std::list<Slab> slabs_;
};

/// Never destroyed: fields may outlive what is.
Slabs& slabs() {
    static Slabs* const all = new Slabs;
    return *all;
}

}  // namespace

void* take_field_memory(std::size_t bytes) {
    return bytes < little ? ::operator new(bytes, std::align_val_t(line)) : slabs().take(block_for(bytes));
}

void give_field_memory(void* memory, std::size_t bytes) noexcept {
    if (bytes < little)
        ::operator delete(memory, std::align_val_t(line));
    else
        slabs().give(static_cast<std::byte*>(memory));
}

}  // namespace chiaro
