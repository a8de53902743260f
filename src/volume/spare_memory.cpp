#include "volume/spare_memory.h"

#include <array>
#include <memory>
#include <mutex>
#include <utility>

namespace chiaro {
namespace {

/// Of what is mapped anew each page costs a fault and is filled with zeros: some 10 core-ms for a moment of 256³ bytes
/// and its bricks. Larger volumes are given back behind the work instead, so that both are never there as a whole.
constexpr std::size_t smallest = std::size_t(1) << 20, largest = std::size_t(24) << 20;

class SpareMemory {
public:
    VoxelBuffer take(std::size_t bytes) {
        const std::lock_guard lock(mutex_);
        for (VoxelBuffer& one : newest_first_)
            if (one.size() == bytes) return std::exchange(one, VoxelBuffer());
        return {};
    }
    void keep(VoxelBuffer memory) {
        const std::lock_guard lock(mutex_);
        if (newest_first_[0].size()) std::swap(newest_first_[0], newest_first_[1]);
        std::swap(newest_first_[0], memory);
    }

private:
    std::mutex mutex_;
    std::array<VoxelBuffer, 2> newest_first_;
};

/// Never destroyed: buffers may go at the end of the process.
SpareMemory& spare_memory() {
    static SpareMemory& spare = *new SpareMemory;
    return spare;
}

struct Lease {
    Lease(VoxelBuffer taken, std::function<void(VoxelBuffer)> back) : memory(std::move(taken)), give(std::move(back)) {}
    ~Lease() { give(std::move(memory)); }
    Lease(const Lease&) = delete;
    Lease& operator=(const Lease&) = delete;
    VoxelBuffer memory;
    std::function<void(VoxelBuffer)> give;
};

}  // namespace

VoxelBuffer lent(VoxelBuffer memory, std::function<void(VoxelBuffer)> back) {
    const std::size_t bytes = memory.size();
    const auto lease = std::make_shared<const Lease>(std::move(memory), std::move(back));
    return VoxelBuffer::borrow(lease->memory.data(), bytes, lease);
}

VoxelBuffer unspecified_bytes(std::size_t bytes) {
    if (bytes < smallest || bytes > largest) return VoxelBuffer(bytes);
    VoxelBuffer memory = spare_memory().take(bytes);
    return lent(memory.size() ? std::move(memory) : VoxelBuffer(bytes),
                [](VoxelBuffer back) { spare_memory().keep(std::move(back)); });
}

}  // namespace chiaro
