// Numbers that the host and a GPU both know.
#pragma once
#include <chiaro/volume.h>

#include <memory>

#include "cuda/device_cache.h"

namespace chiaro {

/// Memory of the host whose numbers a GPU may have made: there they stay, and here they come when first read.
class MirroredBuffer {
public:
    explicit MirroredBuffer(std::size_t bytes) : here_(bytes) {}
    explicit MirroredBuffer(VoxelBuffer memory) : here_(std::move(memory)) {}

    const std::byte* data() const {
        if (deferred_) deferred_->fetch();
        return here_.data();
    }
    /// To be written, after which no GPU knows them. By one thread while they may still have to come.
    std::byte* data() {
        if (deferred_) forget_gpu();
        return here_.data();
    }
    /// Where they are once they have come.
    const std::byte* address() const { return here_.data(); }
    std::size_t size() const { return here_.size(); }
    /// As of a VoxelBuffer; of numbers that no GPU knows.
    void use_small_pages() { here_.use_small_pages(); }

    /// The GPU's copy, made when first asked for.
    const std::byte* on_gpu(cuda::Stream& stream) const { return stream.device_cache()->of(array(), stream); }
    /// The GPU made them, at `made`, and keeps a copy.
    void keep(const std::shared_ptr<cuda::Stream>& stream, const void* made) {
        deferred_ = cuda::keep_resident(stream, array(), made, here_.data());
    }
    /// As kernels are told of it.
    HostArray array() const {
        HostArray array = HostArray::of(life_, here_);
        array.deferred = deferred_;
        return array;
    }

private:
    void forget_gpu() {
        deferred_->fetch();
        deferred_.reset();
        life_ = std::make_shared<const char>();
    }

    VoxelBuffer here_;
    std::shared_ptr<const char> life_ = std::make_shared<const char>();  ///< by which a GPU knows them, once filled
    std::shared_ptr<const DeferredDownload> deferred_;                   ///< fetches them, where they may be elsewhere
};

}  // namespace chiaro
