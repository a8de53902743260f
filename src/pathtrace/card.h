// The path tracer on a card: one thread a pixel, whose sums stay there.
#pragma once
#include <chiaro/progress.h>

#include <vector>

#include "cuda/mirror.h"
#include "pathtrace/launch_card.h"

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

/// The paths of one frame.
template <class Kernel>
class CardTracer {
public:
    /// `arrays`: all that the kernel points into.
    CardTracer(const Device& device, const Kernel& kernel, HostArrays arrays, int width, int height)
        : stream_(device.stream),
          views_(*stream_, std::move(arrays)),
          kernel_(kernel),
          width_(width),
          height_(height),
          sums_(*stream_, std::size_t(width) * height),
          collisions_(*stream_) {
        swap_pointers(views_, kernel_);
        sums_.zero();
        stream_->wait();  // for what the arrays are made from
    }

    /// Adds samples [first, end) and tells the sums so far. It may be cancelled after each.
    void add(int first, int end, const Progress& progress, std::vector<PixelSum>& sums, std::uint64_t& collisions) {
        for (int sample = first; sample < end; ++sample) {
            if (sample > first) stream_->wait();
            if (progress.cancelled()) return;
            kernel::trace_frame(*stream_, kernel_, width_, height_, sample, sums_.data(), collisions_.data());
        }
        const std::uint64_t counted = collisions_.sum();
        stream_->fetch(sums.data(), sums_.data(), sums.size() * sizeof(PixelSum));
        collisions = counted;
    }

private:
    const std::shared_ptr<cuda::Stream> stream_;
    cuda::Views views_;
    Kernel kernel_;
    const int width_, height_;
    cuda::Array<PixelSum> sums_;
    cuda::Counters collisions_;
};

}  // namespace chiaro
