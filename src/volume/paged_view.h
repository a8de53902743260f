// A level of which only some bricks are in memory, as a kernel sees it. A table says in which slot each brick lies;
// where one is absent, a coarser volume that is there as a whole stands for it.
#pragma once
#include <limits>

#include "volume/occupancy.h"
#include "volume/view.h"

namespace chiaro::kernel {

/// In the place of a stored type: any, by bricks.
struct Paged {};

/// Numbers of lanes, one after the other.
template <class F>
struct LaneArray {
    std::int32_t at[LaneTraits<F>::count];
    explicit CHIARO_INLINE LaneArray(Int<F> lanes) { __builtin_memcpy(at, &lanes, sizeof at); }
};

/// The bricks that rays are in, and what the table says of them.
template <class F>
struct HeldBricks {
    Int<F> brick{-1}, slot{0};
};

/// Which bricks are there, what their cells hold, and which of them rays come through.
struct BrickTable {
    static constexpr std::int32_t absent = -1;                                ///< below: that is empty
    static constexpr float anywhere = 1e9f;                                   ///< voxels
    static constexpr std::int32_t cells = 1 << 3 * (brick_bits - cell_bits);  ///< in a brick
    /// Of each brick, signed: its slot; `absent`; or -1 - r, it and all less than r away being empty.
    const std::uint32_t* slots;
    std::uint8_t* seen;         ///< of each brick: set where a ray comes through
    const std::uint8_t* codes;  ///< of each slot's cells, as OccupancyView::cells
    std::int32_t bricks_x, bricks_y;

    template <class F>
    CHIARO_INLINE Int<F> slot_of(Int<F> brick) const {
        return gather_word(slots, typename GatherIndex<F>::type(brick));
    }

    /// Rays leave cubes with the brick, but where bricks are empty. What is absent may be occupied. The lanes that are
    /// wanted hold their brick from here on, until they have left the cube.
    template <class F>
    CHIARO_INLINE Skip<F> skip(Mask<F> wanted, VoxelIndex<F> i, Vec3<F> p, Vec3<F> ahead, Vec3<F> steps_per_voxel,
                               HeldBricks<F>& held) const {
        using I = Int<F>;
        const I brick = brick_of<F>(i, bricks_x, bricks_y);
        const Mask<F> is_new = wanted & (brick != held.brick);
        if (any(is_new)) {
            const LaneArray<F> bricks(brick), asks(select(is_new, I(1), I(0)));
            for (int lane = 0; lane < LaneTraits<F>::count; ++lane)
                if (asks.at[lane]) __atomic_store_n(seen + bricks.at[lane], std::uint8_t(1), __ATOMIC_RELAXED);
            held = {select(is_new, brick, held.brick), select(is_new, slot_of<F>(brick), held.slot)};
        }
        const I slot = held.slot;
        const Mask<F> is_there = slot >= I(0);
        const Mask<F> is_far = slot < I(absent);  // from all that is occupied
        constexpr int bits = brick_bits - cell_bits;
        const auto cell_of = [](I voxel) CHIARO_INLINE_LAMBDA { return (voxel >> I(cell_bits)) & I((1 << bits) - 1); };
        const I cell = (((cell_of(i.z) << I(bits)) + cell_of(i.y)) << I(bits)) + cell_of(i.x);
        const I code = gather_byte(codes, select(is_there, slot * I(cells) + cell, I(0)));
        const F cells_away = select(is_there, to_float((code >> I(1)) << I(cell_bits)), F(anywhere));
        const F bricks_away = F(float(brick_edge)) * to_float(max(I(absent - 1) - slot, I(0)));
        const I cell_begin(~(cell_edge - 1)), brick_begin(~(brick_edge - 1));
        const F in_cubes = steps_to_leave<F>(cells_away, {i.x & cell_begin, i.y & cell_begin, i.z & cell_begin}, p,
                                             ahead, steps_per_voxel);
        const F in_bricks = steps_to_leave<F>(bricks_away, {i.x & brick_begin, i.y & brick_begin, i.z & brick_begin}, p,
                                              F(float(brick_edge / cell_edge)) * ahead, steps_per_voxel);
        return {Mask<F>(is_far | (is_there & ((code & I(1)) == I(0)))), min(in_cubes, in_bricks)};
    }
};

/// What the slots hold, and behind them the coarse volume's bricks, is one array, of less than 2^32 voxels.
template <>
struct VolumeView<Paged> : GridOfVolume {
    VolumeView<float> coarse_grid;
    Float3 coarse_per_voxel, coarse_shift;  ///< coarse voxel = voxel of the level × per_voxel + shift
    BrickTable table;
    std::uint32_t first_coarse;  ///< the coarse volume's first voxel
    const void* voxels;
    std::int32_t voxel_bytes;  ///< 1, 2: whole numbers; 4: floats

    template <class F>
    CHIARO_NOINLINE Location<F> locate(const Vec3<F>& p, const VoxelIndex<F>& i) const {
        const Int<F> slot = table.slot_of<F>(brick_of<F>(i, table.bricks_x, table.bricks_y));
        return locate(p, i, slot < Int<F>(0), slot);
    }
    /// In the bricks that rays hold, where those are not empty.
    template <class F>
    CHIARO_INLINE Location<F> locate(Vec3<F> p, VoxelIndex<F> i, const HeldBricks<F>& held) const {
        return locate(p, i, held.slot == Int<F>(BrickTable::absent), held.slot);
    }

    template <class F>
    CHIARO_INLINE F value(const Location<F>& at) const {
        return as_stored([&](const auto& stored) CHIARO_INLINE_LAMBDA { return stored.value(at); });
    }
    template <class F>
    CHIARO_NOINLINE Four<Two<F>> corners(const Location<F>& at) const {
        return as_stored([&](const auto& stored) CHIARO_INLINE_LAMBDA { return stored.corners(at); });
    }
    /// Stored units per voxel of the level.
    template <class F>
    CHIARO_INLINE Vec3<F> gradient(const Location<F>& at) const {
        const Vec3<F> g = as_stored([&](const auto& stored) CHIARO_INLINE_LAMBDA { return stored.differences(at); });
        // Behind all slots, as unsigned numbers, of which the coarse volume's first is even.
        using I = Int<F>;
        I index;
        __builtin_memcpy(&index, &at.index, sizeof index);
        const Mask<F> is_absent =
            ((index >> I(1)) & I(std::numeric_limits<std::int32_t>::max())) >= I(std::int32_t(first_coarse >> 1));
        if (!any(is_absent)) return g;
        const Float3 s = coarse_per_voxel;
        return {select(is_absent, F(s.x) * g.x, g.x), select(is_absent, F(s.y) * g.y, g.y),
                select(is_absent, F(s.z) * g.z, g.z)};
    }

private:
    /// Slots of what is absent, or empty, are numbers below 0.
    template <class F>
    CHIARO_INLINE Location<F> locate(Vec3<F> p, VoxelIndex<F> i, Mask<F> is_absent, Int<F> slot) const {
        using I = Int<F>;
        I index = max(slot, I(0)) * I(brick_voxels) + place_in_brick(i);
        Vec3<F> t{p.x - to_float(i.x), p.y - to_float(i.y), p.z - to_float(i.z)};
        if (any(is_absent)) stand_in(is_absent, p, index, t);
        return {typename GatherIndex<F>::type(index), t, p};
    }

    /// The coarse volume, in the place of what is absent.
    template <class F>
    CHIARO_NOINLINE void stand_in(const Mask<F>& is_absent, const Vec3<F>& p, Int<F>& index, Vec3<F>& t) const {
        using I = Int<F>;
        const Vec3<F> s(coarse_per_voxel);
        const Vec3<F> q = coarse_grid.clamp(Vec3<F>(mad(p.x, s.x, F(coarse_shift.x)), mad(p.y, s.y, F(coarse_shift.y)),
                                                    mad(p.z, s.z, F(coarse_shift.z))));
        const VoxelIndex<F> j = coarse_grid.voxel(q);
        const I there = place_in_bricks(j, coarse_grid.bricks_x, coarse_grid.bricks_y);
        index = select(is_absent, there + I(std::int32_t(first_coarse)), index);
        t = {select(is_absent, q.x - to_float(j.x), t.x), select(is_absent, q.y - to_float(j.y), t.y),
             select(is_absent, q.z - to_float(j.z), t.z)};
    }

    template <class Use>
    CHIARO_INLINE auto as_stored(const Use& use) const {
        if (voxel_bytes == 1) return use(VolumeView<std::uint8_t>{.voxels = static_cast<const std::uint8_t*>(voxels)});
        if (voxel_bytes == 2)
            return use(VolumeView<std::uint16_t>{.voxels = static_cast<const std::uint16_t*>(voxels)});
        return use(VolumeView<float>{.voxels = static_cast<const float*>(voxels)});
    }
};

}  // namespace chiaro::kernel
