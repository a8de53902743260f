// The bin of a cell's centre: one item is a cell.
#pragma once
#include "illumination/cells/cell_kernel.h"

namespace chiaro::kernel {

/// Bin j holds the stored values about low + j width.
struct BinScale {
    double low, width;
    std::int32_t count;

    CHIARO_INLINE std::uint16_t bin_of(double stored) const {
        const double at = (stored - low) / width + 0.5;
        return std::uint16_t(at > 0 ? at < count - 1 ? at : count - 1 : 0);
    }
};

template <class Voxel>
struct BinKernel {
    VolumeView<Voxel> volume;
    CellCentres cells;
    BinScale scale;
    std::int32_t count[3];  ///< cells
    std::uint16_t* out;     ///< x fastest

    CHIARO_INLINE Voxel of_voxel(std::int32_t x, std::int32_t y, std::int32_t z) const {
        return *voxel_address(volume, x, y, z);
    }
    CHIARO_INLINE float between_voxels(std::int32_t x, std::int32_t y, std::int32_t z) const {
        const Vec3<float> p = volume.clamp(cells.of(x, y, z));
        return volume.value(volume.locate(p, volume.voxel(p)));
    }
    CHIARO_INLINE std::uint16_t bin_at(std::int32_t x, std::int32_t y, std::int32_t z) const {
        return scale.bin_of(cells.are_voxels ? float(of_voxel(x, y, z)) : between_voxels(x, y, z));
    }
    CHIARO_INLINE void operator()(std::int64_t item) const {
        const std::int64_t row = item / count[0];
        out[item] =
            bin_at(std::int32_t(item - row * count[0]), std::int32_t(row % count[1]), std::int32_t(row / count[1]));
    }
};

}  // namespace chiaro::kernel
