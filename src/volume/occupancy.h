// Which parts of a classified volume hold matter: one byte per 8³ cell, the size of the largest aligned cube around the
// cell that is all empty or all occupied. A ray crosses such a cube in one jump.
#pragma once
#include "kernel/gather.h"
#include "kernel/vec.h"
#include "volume/bricks.h"
#include "volume/view.h"

namespace chiaro::kernel {

/// The aligned cube around a point: edge 8 << level voxels.
template <class F> struct Cube {
    Mask<F> empty;
    Int<F> bits;  ///< log2 of its edge
};

struct OccupancyView {
    const std::uint8_t* cells;  ///< 2 * level + occupied; x fastest; one spare byte at the end
    std::int32_t cells_x, cells_y;

    template <class F> CHIARO_INLINE Cube<F> around(VoxelIndex<F> i) const {
        using I = Int<F>;
        const I index = ((i.z >> I(cell_bits)) * I(cells_y) + (i.y >> I(cell_bits))) * I(cells_x) + (i.x >> I(cell_bits));
        const I code = gather_byte(cells, index);
        return {(code & I(1)) == I(0), (code >> I(1)) + I(cell_bits)};
    }
};

/// Steps along one axis from `position` to the side of its aligned cube that lies ahead, a little short of it.
template <class F> CHIARO_INLINE F steps_along(Int<F> voxel, Int<F> cube_bits, F position, F steps_per_voxel) {
    const F margin(1.0f / 512);
    const F low = to_float((voxel >> cube_bits) << cube_bits), edge = to_float(Int<F>(1) << cube_bits);
    const F distance = select(steps_per_voxel > F(0), low + edge - position, position - low) - margin;
    return max(distance, F(0)) * abs(steps_per_voxel);
}

/// How many steps lie between p and the far side of the cube, made a little smaller so that rounding never counts a
/// sample into a cube that it has left.
template <class F>
CHIARO_INLINE F steps_to_leave(const Cube<F>& cube, VoxelIndex<F> i, Vec3<F> p, Vec3<F> steps_per_voxel) {
    return min(steps_along(i.x, cube.bits, p.x, steps_per_voxel.x),
               min(steps_along(i.y, cube.bits, p.y, steps_per_voxel.y), steps_along(i.z, cube.bits, p.z, steps_per_voxel.z)));
}

}  // namespace chiaro::kernel
