// The volume as a kernel sees it: value and gradient at any point.
#pragma once
#include "kernel/gather.h"
#include "kernel/rgba.h"
#include "kernel/vec.h"
#include "volume/bricks.h"
#include "volume/factor_view.h"
#include "volume/spline.h"

namespace chiaro::kernel {

/// A point between eight voxels: where the first lies in memory, and the share of the way to the next along each axis.
template <class F>
struct Location {
    typename GatherIndex<F>::type index;
    Vec3<F> t;
    Vec3<F> p;  ///< the point itself
};

template <class Voxel>
struct VolumeView;
/// What rays hold of the bricks that they are in (paged_view.h): nothing, where all are in memory.
template <class F>
struct HeldBricks;
struct NoBricks {};
template <class F, class Voxel>
static CHIARO_NOINLINE Vec3<F> mean_gradient(const VolumeView<Voxel>& volume, const Vec3<F>& p);

template <class Voxel>
struct ChannelView;
template <class F>
struct EightMatters;
template <class F>
struct FiveExtinctions;
// volume/mixture_view.h:
template <class F, class Voxel>
static CHIARO_NOINLINE RgbaLanes<F> mixed_matter(const VolumeView<Voxel>& volume, const Location<F>& at);
template <class F, class Voxel>
static CHIARO_NOINLINE void mixed_corners(const VolumeView<Voxel>& volume, const Location<F>& at,
                                          EightMatters<F>& sums);
template <class F, class Voxel>
static CHIARO_NOINLINE Vec3<F> mixed_gradient(const VolumeView<Voxel>& volume, const Location<F>& at);
template <class F, class Voxel>
static CHIARO_NOINLINE void mixed_along(const VolumeView<Voxel>& volume, const Location<F>& at, const Vec3<F>& way,
                                        FiveExtinctions<F>& sums);

/// Labels, in bricks as the volume's voxels, so that a location serves both (volume/label_view.h). Null: nothing is
/// hidden, thinned, tinted.
struct LabelView {
    const std::uint8_t *distance, *share;
    const std::uint32_t* tint;
    const std::uint32_t* cells;  ///< of each 4³ cell its one tint, or TintCoding::several

    CHIARO_INLINE bool cuts() const { return distance || share; }
};

/// What samples of a mixture are made of; null: of one value, which each consumer looks up in a table of its own.
template <class Voxel>
struct MixtureView {
    const ChannelView<Voxel>* channels;
    std::int32_t count;
    LabelView labels;
    bool own_colors;  ///< channels without extinction say what colour the matter of the others has
};

/// The voxel whose interval [i, i + 1] holds a point, per axis.
template <class F>
struct VoxelIndex {
    Int<F> x, y, z;
};

template <class F>
CHIARO_INLINE Int<F> brick_of(VoxelIndex<F> i, std::int32_t bricks_x, std::int32_t bricks_y) {
    using I = Int<F>;
    return ((i.z >> I(brick_bits)) * I(bricks_y) + (i.y >> I(brick_bits))) * I(bricks_x) + (i.x >> I(brick_bits));
}
/// Of a voxel in its brick.
template <class F>
CHIARO_INLINE Int<F> place_in_brick(VoxelIndex<F> i) {
    using I = Int<F>;
    const I inside(brick_edge - 1), before(brick_before);
    return ((i.z & inside) + before) * I(brick_slice) + ((i.y & inside) + before) * I(brick_row) + (i.x & inside) +
           before;
}

/// Of a voxel in all bricks: where it would lie were all one brick, and what bricks add. Five products, none of which
/// waits for another.
template <class F>
CHIARO_INLINE Int<F> place_in_bricks(VoxelIndex<F> i, std::int32_t bricks_x, std::int32_t bricks_y) {
    using I = Int<F>;
    const std::uint32_t row = std::uint32_t(bricks_x) * brick_voxels, slice = row * std::uint32_t(bricks_y);
    const auto per_brick = [](std::uint32_t voxels, int within)
                               CHIARO_INLINE_LAMBDA { return I(std::int32_t(voxels - std::uint32_t(within))); };
    const I as_one = i.z * I(brick_slice) + i.y * I(brick_row) + i.x + I(brick_before * (brick_slice + brick_row + 1));
    return as_one + ((i.z >> I(brick_bits)) * per_brick(slice, brick_edge * brick_slice) +
                     (i.y >> I(brick_bits)) * per_brick(row, brick_edge * brick_row) +
                     (i.x >> I(brick_bits)) * per_brick(brick_voxels, brick_edge));
}

/// Voxels in bricks (volume/bricks.h). Points are in voxel coordinates, clamped to the box of the voxel centres.
template <class Voxel>
struct VolumeView {
    const Voxel* voxels;
    std::int32_t bricks_x, bricks_y;
    Float3 last;                          ///< n - 1 per axis
    std::int32_t last_x, last_y, last_z;  ///< last interval's voxel, max(n - 2, 0)
    SplineView<Voxel> spline{};
    FactorView factor{};           ///< of a medium with opacity by gradient
    MixtureView<Voxel> mixture{};  ///< of a medium of several channels, of labels, or in its own colours

    template <class F>
    CHIARO_INLINE Vec3<F> clamp(Vec3<F> p) const {
        return {min(max(p.x, F(0)), F(last.x)), min(max(p.y, F(0)), F(last.y)), min(max(p.z, F(0)), F(last.z))};
    }

    /// Of a clamped point.
    template <class F>
    CHIARO_INLINE VoxelIndex<F> voxel(Vec3<F> p) const {
        return {min(truncate(p.x), Int<F>(last_x)), min(truncate(p.y), Int<F>(last_y)),
                min(truncate(p.z), Int<F>(last_z))};
    }

    template <class F>
    CHIARO_INLINE Location<F> locate(Vec3<F> p, VoxelIndex<F> i) const {
        return {typename GatherIndex<F>::type(place_in_bricks(i, bricks_x, bricks_y)),
                {p.x - to_float(i.x), p.y - to_float(i.y), p.z - to_float(i.z)},
                p};
    }

    /// Trilinear, or of the spline; in stored units.
    template <class F>
    CHIARO_INLINE F value(const Location<F>& at) const {
        if (spline.coefficients) return spline.stored(spline_value<F>(spline.coefficients, at.index, at.t));
        const Four<F> s = along_x(corners(at), at.t.x);
        return lerp(lerp(s.a, s.b, at.t.y), lerp(s.c, s.d, at.t.y), at.t.z);
    }

    /// Between which values in a voxel interval lie; of a spline with its rounding.
    template <class F>
    CHIARO_INLINE Two<F> range(VoxelIndex<F> i) const {
        const Location<F> at = locate({to_float(i.x), to_float(i.y), to_float(i.z)}, i);
        if (spline.coefficients) return spline.stored(spline_range<F>(spline.coefficients, at.index));
        const Four<Two<F>> v = corners(at);
        return {min(min(min(v.a.a, v.a.b), min(v.b.a, v.b.b)), min(min(v.c.a, v.c.b), min(v.d.a, v.d.b))),
                max(max(max(v.a.a, v.a.b), max(v.b.a, v.b.b)), max(max(v.c.a, v.c.b), max(v.d.a, v.d.b)))};
    }

    /// The eight voxels around a point, in pairs along x: (y, z) = (0, 0), (1, 0), (0, 1), (1, 1).
    template <class F>
    CHIARO_INLINE Four<Two<F>> corners(const Location<F>& at) const {
        return gather_two(voxels, at.index, {0, brick_row, brick_slice, brick_slice + brick_row});
    }

    /// Stored units per voxel; of thick slices and smoothed voxels the mean of points around (SplineView::reach); of
    /// mixtures that of extinction.
    template <class F>
    CHIARO_INLINE Vec3<F> gradient(const Location<F>& at) const {
        return is_mixed() ? mixed_gradient<F>(*this, at) : own_gradient(at);
    }
    /// Of its own voxels. Mixtures ask their channels for it: were it `gradient`, it would call itself, and where a
    /// GPU's function may, the compiler does not know how much stack its kernel takes (1 KiB is all that it gets).
    template <class F>
    CHIARO_INLINE Vec3<F> own_gradient(const Location<F>& at) const {
        return spline.reach.x > 0 ? mean_gradient<F>(*this, at.p) : differences(at);
    }

    /// Central differences of one voxel, interpolated. Of splines, too: on balls with edges of .4 to 2 voxels in 8 bits
    /// the spline's own gradient shows two to three times as much of the grid. At the border the missing neighbour is
    /// the border voxel itself. 32 voxels in 12 loads.
    template <class F>
    CHIARO_INLINE Vec3<F> differences(const Location<F>& at) const {
        F value;
        return differences(at, value);
    }
    /// And the trilinear value, which is found with it.
    template <class F>
    CHIARO_INLINE Vec3<F> differences(const Location<F>& at, F& value) const {
        const Vec3<F> t = at.t;
        constexpr int y = brick_row, z = brick_slice;
        const Four<Four<F>> rows = gather_four(voxels - 1, at.index, {0, y, z, z + y});
        const Four<F> s{lerp(rows.a.b, rows.a.c, t.x), lerp(rows.b.b, rows.b.c, t.x), lerp(rows.c.b, rows.c.c, t.x),
                        lerp(rows.d.b, rows.d.c, t.x)};
        value = lerp(lerp(s.a, s.b, t.y), lerp(s.c, s.d, t.y), t.z);
        const F dx = lerp(lerp(slope(rows.a, t.x), slope(rows.b, t.x), t.y),
                          lerp(slope(rows.c, t.x), slope(rows.d, t.x), t.y), t.z);
        const Four<F> sy = along_x(gather_two(voxels, at.index, {-y, 2 * y, z - y, z + 2 * y}), t.x);
        const F dy = lerp(lerp(s.b - sy.a, sy.b - s.a, t.y), lerp(s.d - sy.c, sy.d - s.c, t.y), t.z);
        const Four<F> sz = along_x(gather_two(voxels, at.index, {-z, y - z, 2 * z, y + 2 * z}), t.x);
        const F dz = lerp(lerp(s.c - sz.a, s.d - sz.b, t.y), lerp(sz.c - s.a, sz.d - s.b, t.y), t.z);
        return {F(0.5f) * dx, F(0.5f) * dy, F(0.5f) * dz};
    }

    CHIARO_INLINE bool is_mixed() const { return mixture.channels != nullptr; }
    /// Whether value and gradient are both those of `differences`.
    CHIARO_INLINE bool is_plain() const { return !is_mixed() && !spline.coefficients && !(spline.reach.x > 0); }
    /// What a sample is made of, of mixtures: extinction per mm and colour times extinction.
    template <class F>
    CHIARO_INLINE RgbaLanes<F> matter_at(const Location<F>& at) const {
        return mixed_matter<F>(*this, at);
    }
    /// The same of the eight voxels around a point.
    template <class F>
    CHIARO_INLINE void matter_around(const Location<F>& at, EightMatters<F>& eight) const {
        mixed_corners<F>(*this, at, eight);
    }
    /// Extinction per mm before and behind a place.
    template <class F>
    CHIARO_INLINE void extinction_along(const Location<F>& at, Vec3<F> way, FiveExtinctions<F>& five) const {
        mixed_along<F>(*this, at, way, five);
    }

    CHIARO_INLINE bool has_factor() const { return factor.entries != nullptr; }
    /// What opacity by gradient leaves of the extinction of a value there (mixtures have none of their own).
    template <class F>
    CHIARO_INLINE F factor_at(const Location<F>& at, F stored) const {
        return factor_of(stored, own_gradient(at));
    }
    template <class F>
    CHIARO_INLINE F factor_of(F stored, Vec3<F> gradient) const {
        return factor.of(stored, gradient);
    }

private:
    template <class F>
    static CHIARO_INLINE Four<F> along_x(const Four<Two<F>>& v, F t) {
        return {lerp(v.a.a, v.a.b, t), lerp(v.b.a, v.b.b, t), lerp(v.c.a, v.c.b, t), lerp(v.d.a, v.d.b, t)};
    }
    /// Of a row of four voxels, over two voxels.
    template <class F>
    static CHIARO_INLINE F slope(const Four<F>& row, F t) {
        return lerp(row.c - row.a, row.d - row.b, t);
    }
};

/// What views have in common that find values in another way: points as in voxels, no opacity by gradient and no
/// channels (those are of whole volumes, by voxels).
struct GridOfVolume {
    VolumeView<float> grid;  ///< without voxels

    template <class F>
    CHIARO_INLINE Vec3<F> clamp(Vec3<F> p) const {
        return grid.clamp(p);
    }
    template <class F>
    CHIARO_INLINE VoxelIndex<F> voxel(Vec3<F> p) const {
        return grid.voxel(p);
    }
    static constexpr bool is_mixed() { return false; }
    template <class Place>
    CHIARO_INLINE auto matter_at(const Place& at) const {
        RgbaLanes<decltype(at.t.x)> nothing;
        zero(nothing);
        return nothing;
    }
    template <class Place, class Eight>
    CHIARO_INLINE void matter_around(const Place&, Eight&) const {}
    template <class Place, class F, class Five>
    CHIARO_INLINE void extinction_along(const Place&, Vec3<F>, Five&) const {}
    static constexpr bool has_factor() { return false; }
    template <class Place, class F>
    CHIARO_INLINE F factor_at(const Place&, F) const {
        return F(1);
    }
    template <class F>
    CHIARO_INLINE F factor_of(F, Vec3<F>) const {
        return F(1);
    }
};

/// Of the eight points around p that lie `reach` away along every axis.
template <class F, class Voxel>
static CHIARO_NOINLINE Vec3<F> mean_gradient(const VolumeView<Voxel>& volume, const Vec3<F>& p) {
    const Float3 reach = volume.spline.reach;
    Vec3<F> sum(F(0), F(0), F(0));
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3<F> beside(F(corner & 1 ? reach.x : -reach.x), F(corner & 2 ? reach.y : -reach.y),
                             F(corner & 4 ? reach.z : -reach.z));
        const Vec3<F> q = volume.clamp(p + beside);
        sum = sum + volume.differences(volume.locate(q, volume.voxel(q)));
    }
    return F(0.125f) * sum;
}

}  // namespace chiaro::kernel

#include "volume/mixture_view.h"  // whose channels are volumes themselves
