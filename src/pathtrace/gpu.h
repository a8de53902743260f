// The path tracer on a GPU: one thread a pixel, whose sums stay there.
#pragma once
#include <chiaro/progress.h>

#include <vector>

#include "cuda/device_cache.h"
#include "cuda/pixels.h"
#include "pathtrace/launch_gpu.h"
#include "pathtrace/sums_kernel.h"

namespace chiaro {

template <class Views>
void swap_pointers(Views& views, kernel::RegionsView& regions) {
    views.to_device_pointers(regions.cells, regions.extinction.runs);
}
template <class Views>
void swap_pointers(Views& views, kernel::ColoursView& colours) {
    views.to_device_pointers(colours.red, colours.green, colours.blue);
}
template <class Views>
void swap_pointers(Views& views, kernel::ProbeLightView& probe) {
    views.to_device_pointers(probe.rgb);
    for (kernel::AliasView* table : {&probe.rows, &probe.columns})
        views.to_device_pointers(table->threshold, table->alias);
    views.to_device_pointers(probe.cosines, probe.densities);
}
template <class Views, class Matter>
void swap_pointers(Views& views, kernel::PathKernel<Matter>& kernel) {
    swap_pointers(views, kernel.matter.volume);
    if constexpr (requires { kernel.matter.extinction; }) views.to_device_pointers(kernel.matter.extinction);
    if constexpr (requires { kernel.matter.surface; }) views.to_device_pointers(kernel.matter.surface.opacity);
    if constexpr (requires { kernel.matter.reflection; }) views.to_device_pointers(kernel.matter.reflection.reflected);
    swap_pointers(views, kernel.matter.regions);
    swap_pointers(views, kernel.matter.colours);
    views.to_device_pointers(kernel.start.x, kernel.start.y, kernel.start.z);
    swap_pointers(views, kernel.probe);
}

/// A frame's sums on a GPU.
class GpuPaths {
public:
    GpuPaths(const Device& device, int width, int height);
    virtual ~GpuPaths() = default;

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
class GpuTracer : public GpuPaths {
public:
    /// `arrays`: all that the kernel points into.
    GpuTracer(const Device& device, const Kernel& kernel, HostArrays arrays, int width, int height)
        : GpuPaths(device, width, height), views_(*stream_, std::move(arrays)), kernel_(kernel) {
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
