#include "illumination/histogram/cells.h"

#include "core/threads.h"
#include "cuda/run.h"
#include "volume/device_view.h"

namespace chiaro {
namespace {

template <class Voxel>
kernel::BinKernel<Voxel> bin_kernel(const DeviceVolume::Data& volume, const BinnedCells& cells, std::uint16_t* out) {
    const auto [nx, ny, nz] = cells.grid.count;
    return {view_of<Voxel>(volume), cell_centres(cells.grid), cells.binning.scale(), {nx, ny, nz}, out};
}

template <class Voxel>
void bin_here(const Device& device, const DeviceVolume::Data& volume, BinnedCells& out, Progress& progress) {
    const kernel::BinKernel<Voxel> kernel = bin_kernel<Voxel>(volume, out, out.data());
    std::vector<std::uint16_t> of_stored;
    if (sizeof(Voxel) <= 2 && kernel.cells.are_voxels)
        for (std::size_t v = 0; v < std::size_t(1) << (8 * sizeof(Voxel)); ++v)
            of_stored.push_back(out.binning.bin_of(double(v)));
    const auto [nx, ny, nz] = out.grid.count;
    parallel_for(device.threads, std::int64_t(ny) * nz, 16, "histogram bins", progress,
                 [&, nx = nx, ny = ny](std::int64_t first, std::int64_t end) {
                     for (auto row = first; row < end; ++row) {
                         const int y = int(row % ny), z = int(row / ny);
                         std::uint16_t* const to = kernel.out + row * nx;
                         if (of_stored.empty())
                             for (int x = 0; x < nx; ++x) to[x] = kernel.bin_at(x, y, z);
                         else
                             for (int x = 0; x < nx; ++x) to[x] = of_stored[std::size_t(kernel.of_voxel(x, y, z))];
                     }
                 });
}

/// Where the voxels are, their bins stay.
template <class Voxel>
void bin_on_gpu(const Device& device, const DeviceVolume::Data& volume, BinnedCells& out) {
    cuda::Stream& stream = *device.stream;
    const cuda::Array<std::uint16_t> made(stream, out.grid.size());
    kernel::BinKernel<Voxel> kernel = bin_kernel<Voxel>(volume, out, made.data());
    HostArrays arrays;
    volume.add_to(arrays);
    cuda::Views views(stream, std::move(arrays));
    swap_pointers(views, kernel.volume);
    kernel::run_on_gpu(stream, std::int64_t(made.size()), kernel);
    out.buffer.keep(device.stream, made.data());
}

}  // namespace

Binning make_binning(const DeviceVolume::Data& volume) {
    const double low = volume.stored_min, high = volume.stored_max;
    if (!(high > low)) return {1, low, 1};
    if (volume.whole_numbers && high - low < Binning::most) return {int(high - low) + 1, low, 1};
    return {Binning::most, low, (high - low) / (Binning::most - 1)};
}

std::vector<std::uint64_t> BinnedCells::counts() const {
    std::vector<std::uint64_t> counts(std::size_t(binning.count));
    const std::uint16_t* bins = data();
    for (std::size_t i = 0; i < grid.size(); ++i) ++counts[bins[i]];
    return counts;
}

kernel::BinGrid BinnedCells::view_on_gpu(cuda::Stream& stream) const {
    return {reinterpret_cast<const std::uint16_t*>(buffer.on_gpu(stream)),
            {grid.count[0], grid.count[1], grid.count[2]}};
}

BinnedCells bin_cells(const Device& device, const DeviceVolume::Data& volume, Progress& progress) {
    BinnedCells out(make_cell_grid(volume.dimensions, volume.geometry), make_binning(volume));
    with_stored_voxel(volume, [&](auto voxel) {
        using Voxel = decltype(voxel);
        if (!cuda::try_gpu(device, [&] { bin_on_gpu<Voxel>(device, volume, out); }))
            bin_here<Voxel>(device, volume, out, progress);
    });
    progress.check();
    return out;
}

}  // namespace chiaro
