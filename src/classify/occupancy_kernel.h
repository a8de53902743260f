// Which cells hold something visible, and how far around each the cells are all like it.
#pragma once
#include "kernel/lanes.h"

namespace chiaro::kernel {

/// Whether something may be seen where the stored values lie between two: of a transfer function or of isosurfaces.
struct RangeView {
    static constexpr int max_surfaces = 8;
    const std::int32_t* before;              ///< how many entries of the optical table before each are visible;
    double index_scale, index_offset, last;  ///< null: surfaces
    double surfaces[max_surfaces];           ///< stored values
    std::int32_t surface_count;

    CHIARO_INLINE bool operator()(float low, float high) const {
        const double beyond = reach_beyond(low, high);
        if (before) {
            const double reach = low == high ? 0 : 1.0 / 256 + index_scale * beyond;
            return before[entry(high, reach) + 1] > before[entry(low, -reach)];
        }
        for (std::int32_t s = 0; s < surface_count; ++s)
            if (surfaces[s] >= low - beyond && surfaces[s] <= high + beyond) return true;
        return false;
    }

private:
    /// Rounding in interpolation can reach a little beyond the values, unless they are all the same.
    static CHIARO_INLINE double reach_beyond(double low, double high) {
        const double a = low < 0 ? -low : low, b = high < 0 ? -high : high;
        return low == high ? 0 : (a < b ? b : a) * 4e-7;
    }
    CHIARO_INLINE std::int32_t entry(double stored, double reach) const {
        const double index = stored * index_scale + index_offset + reach + 0.5;
        return std::int32_t(index < 0 ? 0 : last < index ? last : index);
    }
};

inline constexpr std::uint8_t farthest = 126;  ///< distances are clamped, so that one fits beside the occupied bit

/// A cell's byte: distance to the nearest cell of the other kind, and its own kind.
CHIARO_INLINE std::uint8_t cell_code(std::uint8_t distance, bool occupied) {
    return std::uint8_t(2 * (distance - 1) + occupied);
}

/// For many threads: to each cell the distances to the nearest empty and to the nearest occupied cell, [2][cells], in
/// the maximum of the three axes, one axis after the other: d'(i) = min over j of max(|i - j|, d(j)).
struct OccupancyPass {
    const std::uint8_t* from;
    std::uint8_t* to;
    std::int64_t cells;

    CHIARO_INLINE void begin(std::int64_t i, bool occupied) const {
        to[i] = occupied ? farthest : 0;
        to[cells + i] = occupied ? 0 : farthest;
    }
    /// Along an axis of n cells, `stride` apart.
    CHIARO_INLINE void along(std::int64_t i, std::int64_t stride, std::int32_t n) const {
        const std::int32_t at = std::int32_t(i / stride % n);
        for (int kind = 0; kind < 2; ++kind) {
            const std::uint8_t* line = from + kind * cells + i;
            std::int32_t nearest = *line;
            for (std::int32_t d = 1; d < nearest; ++d) {
                if (d <= at) nearest = min(nearest, max(d, std::int32_t(line[-d * stride])));
                if (d < n - at) nearest = min(nearest, max(d, std::int32_t(line[d * stride])));
            }
            to[kind * cells + i] = std::uint8_t(nearest);
        }
    }
    CHIARO_INLINE std::uint8_t code(std::int64_t i) const {
        const bool occupied = from[cells + i] == 0;
        return cell_code(from[occupied ? i : cells + i], occupied);
    }
};

/// What the cells' stored values say.
struct CellValueRanges {
    const float *low, *high;
    RangeView is_visible;
    CHIARO_INLINE bool occupied(std::int64_t i) const { return is_visible(low[i], high[i]); }
};

}  // namespace chiaro::kernel
