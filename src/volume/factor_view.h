// How much of the extinction of a value remains where values rise so steeply: opacity by gradient.
#pragma once
#include "kernel/gather.h"
#include "kernel/math.h"
#include "kernel/vec.h"

namespace chiaro::kernel {

struct FactorView {
    const float* entries;  ///< [row][column], in [0, 1]; null: all of it everywhere
    std::int32_t columns;
    float scale, offset, last_column;  ///< column = stored * scale + offset, rounding included
    float last_row;
    Float3 world_x, world_y, world_z;  ///< rows of the matrix from a gradient, stored units per voxel, to rows

    template <class F>
    CHIARO_INLINE Int<F> index(F stored, Vec3<F> gradient) const {
        const Vec3<F> g{dot(Vec3<F>(world_x), gradient), dot(Vec3<F>(world_y), gradient),
                        dot(Vec3<F>(world_z), gradient)};
        const Int<F> row = truncate(min(sqrt(dot(g, g)), F(last_row)) + F(0.5f));
        const Int<F> column = truncate(min(max(mad(stored, F(scale), F(offset)), F(0)), F(last_column)));
        return row * Int<F>(columns) + column;
    }
    /// f(v, |∇v|), which multiplies κ(v).
    template <class F>
    CHIARO_INLINE F of(F stored, Vec3<F> gradient) const {
        return gather_float(entries, index(stored, gradient));
    }
};

/// 1 - (1 - α)^f: the opacity of what has f times the extinction.
template <class F>
CHIARO_INLINE F opacity_of_share(F alpha, F f) {
    return F(1) - pow(max(F(1) - alpha, F(0)), f);
}

}  // namespace chiaro::kernel
