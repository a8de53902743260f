// Values at a row of points between voxels: several at a time (F = Lanes), or one by one.
#pragma once
#include "kernel/row.h"
#include "volume/view.h"

namespace chiaro::kernel {

/// Points (x[i], y, z), voxels, clamped to the volume. Both arrays are whole packs of sixteen.
struct ValueRow {
    const float* x;
    float y, z;
    std::int32_t count;
    float* to;  ///< stored units

    template <class F, class Voxel>
    CHIARO_INLINE Location<F> located(const VolumeView<Voxel>& volume, std::int32_t i) const {
        const Vec3<F> p = volume.clamp(Vec3<F>(load_row<F>(x + i), F(y), F(z)));
        return volume.locate(p, volume.voxel(p));
    }
};

template <class F, class Voxel>
CHIARO_INLINE void find_values(const VolumeView<Voxel>& volume, const ValueRow& row) {
    for (std::int32_t i = 0; i < row.count; i += LaneTraits<F>::count)
        store_row(row.to + i, volume.value(row.located<F>(volume, i)));
}

}  // namespace chiaro::kernel
