#include "illumination/histogram/cells.h"

#include "core/threads.h"
#include "volume/device_view.h"

namespace chiaro {
namespace {

/// Fills rows of bins from a volume of one stored type.
template <class Voxel>
class CellBinner {
public:
    CellBinner(const DeviceVolume::Data& volume, BinnedCells& out)
        : view_(view_of<Voxel>(volume)), out_(out), binning_(out.binning) {
        if constexpr (sizeof(Voxel) <= 2)
            for (std::size_t v = 0; v < std::size_t(1) << (8 * sizeof(Voxel)); ++v)
                of_stored_.push_back(binning_.bin_of(double(v)));
    }

    void fill(int y, int z) const {
        std::uint16_t* row = out_.data() + out_.grid.index(0, y, z);
        for (int x = 0; x < out_.grid.count[0]; ++x) row[x] = bin_at(x, y, z);
    }

private:
    std::uint16_t bin_at(int x, int y, int z) const {
        const Vec3 centre = out_.grid.voxel_of(x, y, z);
        const auto p = view_.clamp(kernel::Vec3<float>(float(centre.x), float(centre.y), float(centre.z)));
        const auto voxel = view_.voxel(p);
        const auto at = view_.locate(p, voxel);
        if (!out_.grid.is_voxel_grid) return binning_.bin_of(view_.value(at));
        // The last voxel of an axis lies behind its last interval.
        const Voxel stored = view_.voxels[std::uint32_t(at.index) + (x - voxel.x) + (y - voxel.y) * brick_row +
                                          (z - voxel.z) * brick_slice];
        if constexpr (sizeof(Voxel) <= 2)
            return of_stored_[stored];
        else
            return binning_.bin_of(stored);
    }

    const kernel::VolumeView<Voxel> view_;
    BinnedCells& out_;
    const Binning& binning_;
    std::vector<std::uint16_t> of_stored_;
};

}  // namespace

Binning make_binning(const DeviceVolume::Data& volume) {
    const double low = volume.stored_min, high = volume.stored_max;
    if (!(high > low)) return {1, low, 1};
    if (volume.whole_numbers && high - low < Binning::most) return {int(high - low) + 1, low, 1};
    return {Binning::most, low, (high - low) / (Binning::most - 1)};
}

std::vector<std::uint64_t> BinnedCells::counts() const {
    std::vector<std::uint64_t> counts(std::size_t(binning.count));
    for (std::size_t i = 0; i < grid.size(); ++i) ++counts[data()[i]];
    return counts;
}

BinnedCells bin_cells(const DeviceVolume::Data& volume, Progress& progress) {
    BinnedCells out{make_cell_grid(volume.dimensions, volume.geometry), make_binning(volume), {}};
    out.buffer = VoxelBuffer(out.grid.size() * sizeof(std::uint16_t));
    with_stored_voxel(volume, [&](auto voxel) {
        const CellBinner<decltype(voxel)> binner(volume, out);
        const auto [nx, ny, nz] = out.grid.count;
        parallel_for(volume.device.threads, std::int64_t(ny) * nz, 16, "histogram bins", progress,
                     [&, ny = ny](std::int64_t first, std::int64_t end) {
                         for (auto row = first; row < end; ++row) binner.fill(int(row % ny), int(row / ny));
                     });
    });
    progress.check();
    return out;
}

}  // namespace chiaro
