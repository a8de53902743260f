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
};

template <class F, class Voxel>
CHIARO_INLINE void find_values(const VolumeView<Voxel>& volume, const ValueRow& row) {
    for (std::int32_t i = 0; i < row.count; i += LaneTraits<F>::count) {
        const Vec3<F> p = volume.clamp(Vec3<F>(load_row<F>(row.x + i), F(row.y), F(row.z)));
        store_row(row.to + i, volume.value(volume.locate(p, volume.voxel(p))));
    }
}

}  // namespace chiaro::kernel
