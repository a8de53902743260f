// What histograms are made of: a bin for every cell.
#pragma once
#include <chiaro/progress.h>

#include "illumination/cells/grid.h"
#include "illumination/histogram/bin_grid.h"
#include "illumination/histogram/bin_kernel.h"
#include "volume/device_volume.h"

namespace chiaro {

/// Bins of equal width over the stored values that occur: one for each value of 8-bit volumes, and of any whole numbers
/// while these are at most 4096; else 4096 (12 bit), to which 16-bit and floating-point values are rounded.
struct Binning {
    static constexpr int most = 4096;
    int count = 1;
    double low = 0, width = 1;  ///< bin j holds the stored values about low + j width

    double stored_of(int bin) const { return low + bin * width; }
    std::uint16_t bin_of(double stored) const { return scale().bin_of(stored); }
    kernel::BinScale scale() const { return {low, width, count}; }
    bool operator==(const Binning&) const = default;
};
Binning make_binning(const DeviceVolume::Data& volume);

/// The bin of each cell's centre, x fastest; between voxels (where these are no cubes) interpolated first.
struct BinnedCells {
    CellGrid grid;
    Binning binning;
    MirroredBuffer buffer;

    BinnedCells(const CellGrid& cells, const Binning& bins)
        : grid(cells), binning(bins), buffer(cells.size() * sizeof(std::uint16_t)) {}
    const std::uint16_t* data() const { return reinterpret_cast<const std::uint16_t*>(buffer.data()); }
    std::uint16_t* data() { return reinterpret_cast<std::uint16_t*>(buffer.data()); }
    std::vector<std::uint64_t> counts() const;  ///< cells in each bin: the global histogram

    std::array<float, 3> gradient(int x, int y, int z) const {
        const kernel::Float3 g = view().gradient(x, y, z);
        return {g.x, g.y, g.z};
    }
    kernel::BinGrid view() const { return {data(), {grid.count[0], grid.count[1], grid.count[2]}}; }
    kernel::BinGrid view_on_gpu(cuda::Stream& stream) const;
};

/// Cost: one look-up a cell. A GPU keeps them until the host reads them. Throws Error{interrupted} when cancelled.
BinnedCells bin_cells(const Device& device, const DeviceVolume::Data& volume, Progress& progress);

}  // namespace chiaro
