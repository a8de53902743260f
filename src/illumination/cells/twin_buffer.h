// Numbers that the host and a card both know.
#pragma once
#include <chiaro/volume.h>

#include <memory>
#include <mutex>

#include "cuda/mirror.h"

namespace chiaro {

/// Memory of the host whose numbers a card may have made: there they stay, and here they come when first read.
class TwinBuffer {
public:
    explicit TwinBuffer(std::size_t bytes) : here_(bytes) {}

    const std::byte* data() const {
        if (late_) come();
        return here_.data();
    }
    /// To be written, after which no card knows them. By one thread while they may still have to come.
    std::byte* data() {
        if (late_) forget_card();
        return here_.data();
    }
    /// Where they are once they have come.
    const std::byte* address() const { return here_.data(); }
    std::size_t size() const { return here_.size(); }

    /// The card's copy, made when first asked for.
    const std::byte* on_card(cuda::Stream& stream) const;
    /// The card made them, at `made`, and keeps a copy.
    void keep(const std::shared_ptr<cuda::Stream>& stream, const void* made);
    /// As kernels are told of it.
    void add_to(HostArrays& arrays) const { arrays.add(life_, here_); }

private:
    struct Late {
        std::shared_ptr<cuda::Stream> stream;
        std::once_flag came;
    };
    HostArray array() const { return HostArray::of(life_, here_); }
    void come() const;
    void forget_card();

    mutable VoxelBuffer here_;
    std::shared_ptr<const char> life_ = std::make_shared<const char>();  ///< by which a card knows them, once filled
    std::unique_ptr<Late> late_;
};

}  // namespace chiaro
