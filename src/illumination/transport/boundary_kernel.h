// Which opaque cells a surface leaves mostly open (boundary_cells.h): one item a cell.
#pragma once
#include <cmath>

#include "illumination/cells/cell_kernel.h"

namespace chiaro::kernel {

/// How much of a cell hard matter fills, and which way its middle lies (not divided by how many points it is of).
struct Fill {
    float share = 1, middle[3]{};

    CHIARO_INLINE bool is_thin() const { return share > 0 && share <= 0.5f; }
};

/// n points of each cell per axis, in voxels.
template <int count>
struct PointLattice {
    static constexpr int n = count;
    double voxels_per_cell[3];

    static CHIARO_INLINE double offset(std::int32_t i) { return (i + 0.5) / n - 0.5; }
    CHIARO_INLINE double along(int axis, std::int32_t point) const {
        return (point / n + offset(point % n) + 0.5) * voxels_per_cell[axis] - 0.5;
    }
};

/// The stored values at them, straight from the volume.
template <class Voxel, int n>
struct ValuesAtPoints {
    VolumeView<Voxel> volume;
    PointLattice<n> points;

    CHIARO_INLINE float at(std::int32_t x, std::int32_t y, std::int32_t z) const {
        const Vec3<float> p =
            volume.clamp(Vec3<float>(float(points.along(0, x)), float(points.along(1, y)), float(points.along(2, z))));
        return volume.value(volume.locate(p, volume.voxel(p)));
    }
};

/// Which values are hard, and where there is matter at all.
struct HardView {
    const std::uint8_t* is_hard;  ///< entry by entry of the optical table
    double index_scale, index_offset, last_entry;
    double last[3];  ///< where the volume ends
    CellCentres clip;

    CHIARO_INLINE bool holds(float stored, double x, double y, double z) const {
        const double index = stored * index_scale + index_offset + 0.5;
        if (!is_hard[std::int32_t(index < 0 ? 0 : last_entry < index ? last_entry : index)]) return false;
        for (std::int32_t i = 0; i < clip.plane_count; ++i) {
            const CellCentres::Plane& n = clip.planes[i];
            if (n.x * x + n.y * y + n.z * z > n.d) return false;
        }
        return true;
    }
};

/// What hard matter fills of cells. `Values`: at(x, y, z) of a point.
template <class Values, int n>
struct HardPoints {
    Values values;
    PointLattice<n> points;
    HardView matter;

    CHIARO_INLINE Fill of_node(std::int32_t x, std::int32_t y, std::int32_t z) const {
        Fill fill;
        std::int32_t count = 0;
        for (std::int32_t k = 0; k < n; ++k)
            for (std::int32_t j = 0; j < n; ++j)
                for (std::int32_t i = 0; i < n; ++i) {
                    if (!is_hard(x * n + i, y * n + j, z * n + k)) continue;
                    fill.middle[0] += float(points.offset(i)), fill.middle[1] += float(points.offset(j));
                    fill.middle[2] += float(points.offset(k));
                    ++count;
                }
        fill.share = float(count) / float(n * n * n);
        return fill;
    }

private:
    CHIARO_INLINE bool is_hard(std::int32_t x, std::int32_t y, std::int32_t z) const {
        const double px = points.along(0, x), py = points.along(1, y), pz = points.along(2, z);
        if (px > matter.last[0] || py > matter.last[1] || pz > matter.last[2]) return false;
        return matter.holds(values.at(x, y, z), px, py, pz);
    }
};

/// What there is of a cell and its 26 neighbours, a bit each.
using Around = std::uint32_t;
CHIARO_INLINE Around bit_of(int i, int j, int k) { return Around(1) << ((k + 1) * 9 + (j + 1) * 3 + i + 1); }
/// All places within one of those.
CHIARO_INLINE Around beside(Around p) {
    constexpr Around all = 0x7ffffff, x0 = 0x1249249, y0 = 0x01c0e07;  // the lowest along x, along y
    p |= (p & ~(x0 << 2)) << 1 | (p & ~x0) >> 1;
    p |= (p & ~(y0 << 6)) << 3 | (p & ~y0) >> 3;
    return (p | p << 9 | p >> 9) & all;
}

/// Whether what is clear hangs together, and touches all that is thin.
CHIARO_INLINE bool is_one_side(Around clear, Around thin) {
    Around piece = clear & (~clear + 1);
    for (Around before = 0; piece != before;) {
        before = piece;
        piece |= beside(piece) & clear;
    }
    return piece == clear && (thin & ~beside(piece)) == 0;
}

struct BoundaryView {
    std::int32_t nx, ny, nz, unused;
    const std::uint8_t* opaque;  ///< with a halo of one about the grid, which is not
    const Fill* fills;           ///< of those that are asked for
    const std::uint8_t* thin;    ///< those that are backed

    CHIARO_INLINE std::int64_t halo_place(std::int32_t x, std::int32_t y, std::int32_t z) const {
        return (std::int64_t(z + 1) * (ny + 2) + y + 1) * (nx + 2) + x + 1;
    }
    CHIARO_INLINE std::int64_t place(std::int32_t x, std::int32_t y, std::int32_t z) const {
        return (std::int64_t(z) * ny + y) * nx + x;
    }
    CHIARO_INLINE bool is_opaque(std::int32_t x, std::int32_t y, std::int32_t z) const {
        return opaque[halo_place(x, y, z)] != 0;
    }
    /// On a surface: in a corner between walls only an edge may lie in the open.
    CHIARO_INLINE bool is_asked(std::int32_t x, std::int32_t y, std::int32_t z) const {
        if (!is_opaque(x, y, z)) return false;
        for (int k = -1; k <= 1; ++k)
            for (int j = -1; j <= 1; ++j)
                for (int i = -1; i <= 1; ++i)
                    if (!is_opaque(x + i, y + j, z + k)) return true;
        return false;
    }
    /// Thin, before a cell that is not.
    CHIARO_INLINE bool is_backed(std::int32_t x, std::int32_t y, std::int32_t z) const {
        const Fill& here = fills[place(x, y, z)];
        if (!is_opaque(x, y, z) || !here.is_thin()) return false;
        const float* m = here.middle;
        const float most = max(max(abs(m[0]), abs(m[1])), abs(m[2]));
        std::int32_t step[3];
        for (int a = 0; a < 3; ++a) step[a] = abs(m[a]) > 0.5f * most ? (m[a] > 0 ? 1 : -1) : 0;
        const std::int32_t i = x + step[0], j = y + step[1], k = z + step[2];
        return is_opaque(i, j, k) && !fills[place(i, j, k)].is_thin();
    }
    /// Backed, and nothing parts here, were all the thin cells around open: a thin cell on the other side may not leave
    /// a wall of edges.
    CHIARO_INLINE bool is_open(std::int32_t x, std::int32_t y, std::int32_t z) const {
        if (!thin[place(x, y, z)]) return false;
        Around clear = 0, thin_ones = 0;
        for (int k = -1; k <= 1; ++k)
            for (int j = -1; j <= 1; ++j)
                for (int i = -1; i <= 1; ++i) {
                    if (!is_opaque(x + i, y + j, z + k))
                        clear |= bit_of(i, j, k);
                    else if (thin[place(x + i, y + j, z + k)])
                        thin_ones |= bit_of(i, j, k);
                }
        return is_one_side(clear, thin_ones);
    }
};

/// A step of the cells of a grid.
template <class Step>
struct OnSkin {
    Step step;
    BoundaryView view;

    CHIARO_INLINE void operator()(std::int64_t cell, std::int32_t x, std::int32_t y, std::int32_t z) const {
        step(view, cell, x, y, z);
    }
};
/// Into zeros.
struct MarkOpaque {
    const float* depth;
    float from;
    std::uint8_t* to;
    CHIARO_INLINE void operator()(const BoundaryView& view, std::int64_t cell, std::int32_t x, std::int32_t y,
                                  std::int32_t z) const {
        to[view.halo_place(x, y, z)] = depth[cell] >= from;
    }
};
/// Two points per axis tell most cells that are full.
template <class Few, class All>
struct FindFill {
    Few few;
    All all;
    Fill* to;
    CHIARO_INLINE void operator()(const BoundaryView& view, std::int64_t cell, std::int32_t x, std::int32_t y,
                                  std::int32_t z) const {
        Fill fill;
        if (view.is_asked(x, y, z)) {
            fill = few.of_node(x, y, z);
            if (fill.share <= 0.5f) fill = all.of_node(x, y, z);
        }
        to[cell] = fill;
    }
};
struct FindThin {
    std::uint8_t* to;
    CHIARO_INLINE void operator()(const BoundaryView& view, std::int64_t cell, std::int32_t x, std::int32_t y,
                                  std::int32_t z) const {
        to[cell] = view.is_backed(x, y, z);
    }
};
/// Open cells hold what the hard matter in them leaves.
struct OpenBoundary {
    const float* depth;
    float* to;
    std::uint8_t* is_open;
    CHIARO_INLINE void operator()(const BoundaryView& view, std::int64_t cell, std::int32_t x, std::int32_t y,
                                  std::int32_t z) const {
        is_open[cell] = view.is_open(x, y, z);
        to[cell] = is_open[cell] ? -::logf(1 - view.fills[cell].share) : depth[cell];
    }
};

/// Of the volume.
inline constexpr int few_points = 2, all_points = 4;  ///< of a cell, per axis
template <class Voxel>
using FindFillOf = FindFill<HardPoints<ValuesAtPoints<Voxel, few_points>, few_points>,
                            HardPoints<ValuesAtPoints<Voxel, all_points>, all_points>>;

}  // namespace chiaro::kernel
