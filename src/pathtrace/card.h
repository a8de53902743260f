// The path tracer on a card: one thread a pixel, whose sums stay there.
#pragma once
#include <chiaro/progress.h>

#include <vector>

#include "cuda/mirror.h"
#include "cuda/pixels.h"
#include "pathtrace/launch_card.h"
#include "pathtrace/sums_kernel.h"

namespace chiaro {

template <class Views>
void swap_pointers(Views& views, kernel::RegionsView& regions) {
    views.swap(regions.cells, regions.extinction.runs);
}
template <class Views>
void swap_pointers(Views& views, kernel::ColoursView& colours) {
    views.swap(colours.red, colours.green, colours.blue);
}
template <class Views>
void swap_pointers(Views& views, kernel::ProbeLightView& probe) {
    views.swap(probe.rgb);
    for (kernel::AliasView* table : {&probe.rows, &probe.columns}) views.swap(table->threshold, table->alias);
    views.swap(probe.cosines, probe.densities);
}
template <class Views, class Matter>
void swap_pointers(Views& views, kernel::PathKernel<Matter>& kernel) {
    views.swap(kernel.matter.volume.voxels);
    if constexpr (requires { kernel.matter.extinction; }) views.swap(kernel.matter.extinction);
    swap_pointers(views, kernel.matter.regions);
    swap_pointers(views, kernel.matter.colours);
    views.swap(kernel.start.x, kernel.start.y, kernel.start.z);
    swap_pointers(views, kernel.probe);
}

/// A frame's sums on a card.
class CardPaths {
public:
    CardPaths(const Device& device, int width, int height);
    virtual ~CardPaths() = default;

    /// Adds samples until there are so many. It may be cancelled after each.
    void add_up_to(int end, const Progress& progress);
    void show(std::shared_ptr<cuda::Pixels>& pixels) const;
    void measure(std::vector<kernel::PathNoise>& runs) const;

    int samples() const { return samples_; }
    std::uint64_t collisions() const { return collisions_.sum(); }
    std::vector<PixelSum> sums() const;

protected:
    /// Begins another path for each pixel.
    virtual void trace(int sample) = 0;

    const std::shared_ptr<cuda::Stream> stream_;
    const int width_, height_;
    cuda::Array<PixelSum> sums_;
    cuda::Counters collisions_;

private:
    cuda::Array<kernel::PathNoise> noise_;
    int samples_ = 0;
};

template <class Kernel>
class CardTracer : public CardPaths {
public:
    /// `arrays`: all that the kernel points into.
    CardTracer(const Device& device, const Kernel& kernel, HostArrays arrays, int width, int height)
        : CardPaths(device, width, height), views_(*stream_, std::move(arrays)), kernel_(kernel) {
        swap_pointers(views_, kernel_);
        stream_->wait();  // for what the arrays are made from
    }

private:
    void trace(int sample) override {
        kernel::trace_frame(*stream_, kernel_, width_, height_, sample, sums_.data(), collisions_.data());
    }

    cuda::Views views_;
    Kernel kernel_;
};

}  // namespace chiaro
